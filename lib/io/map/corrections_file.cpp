// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/corrections_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "detection/detection.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/json_value.hpp"
#include "io/map/rounded.hpp"
#include "io/sane_limits.hpp"
#include "text/encoded_text.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using Eigen::Vector2d;
using mapping::Correction;
using mapping::CorrectionKind;
using mapping::CorrectionTarget;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::size_t kLineMax_bytes = 65536;

constexpr double kMaxInt = std::numeric_limits<std::int32_t>::max() - 1;

double metres(double value) { return rounded(value, 1e4); }

Json target_json(const CorrectionTarget& target) {
  Json json{{"id", target.id},
            {"x_m", metres(target.p_map.x())},
            {"y_m", metres(target.p_map.y())},
            {"class", label_text(target.label)}};
  if (target.width_m > 0.0) json["width_m"] = metres(target.width_m);
  return json;
}

/// The fields of one line, with type checks.
class Line {
 public:
  Line(std::string_view text, const std::string& place)
      : source_{place, "correct or remove the line"}, json_(Json::parse(text, nullptr, false)) {
    if (!json_.is_object()) fail("is not a JSON object");
  }

  [[noreturn]] void fail(const std::string& why) const { value_.fail(why); }

  std::int32_t integer(const char* key, std::int64_t lo) {
    return used(key).whole(key, static_cast<double>(lo), kMaxInt);
  }
  std::string text(const char* key) {
    std::string text = used(key).text(key);
    if (!is_correction_text(text)) {
      fail(std::string(key) + " is too long, or contains control characters");
    }
    return text;
  }
  bool has(const char* key) const { return value_.has(key); }

  double width_m() { return width_m(used("width_m")); }
  Label label() { return label(used("class")); }
  std::vector<CorrectionTarget> targets(std::size_t least, std::size_t most) {
    std::vector<CorrectionTarget> targets;
    for (const JsonValue& value : used("landmarks").list("landmarks")) {
      targets.push_back(
          {value.whole("id", 0, kMaxInt), value.place("x_m", "y_m"), label(value), width_m(value)});
    }
    if (targets.size() < least || targets.size() > most) {
      fail("landmarks has the wrong number of landmarks for this correction");
    }
    return targets;
  }
  std::vector<Vector2d> places(std::size_t count) {
    std::vector<Vector2d> places = used("places_m").places("places_m");
    if (places.size() != count) fail("places_m must be " + std::to_string(count) + " [x, y]");
    return places;
  }
  CorrectionKind kind() {
    const std::string word = text("what");
    for (const CorrectionKind kind : mapping::kAllCorrectionKinds) {
      if (word == mapping::correction_word(kind)) return kind;
    }
    fail("\"" + printable_text(word) +
         "\" is a kind of correction that this version does not know");
  }
  std::int64_t utime() {
    const std::string when = text("when");
    std::tm utc{};
    const char* end = ::strptime(when.c_str(), "%Y-%m-%dT%H:%M:%SZ", &utc);
    if (end == nullptr || *end != '\0') fail("`when` must be a time like 2026-05-04T08:00:00Z");
    return std::int64_t{1000000} * static_cast<std::int64_t>(::timegm(&utc));
  }

  /// An unknown field is from a later release or a mistake, so it is an error.
  void require_all_used() const {
    for (const auto& [key, value] : json_.items()) {
      if (std::find(used_.begin(), used_.end(), key) == used_.end()) {
        fail("\"" + printable_text(key) + "\" does not belong to this kind of correction");
      }
    }
  }

 private:
  static double width_m(const JsonValue& value) {
    return value.has("width_m") ? value.number("width_m", 0.0, kMaxWidth_m) : 0.0;
  }
  static Label label(const JsonValue& value) {
    const std::string word = value.text("class");
    for (const Label label : {Label::kTree, Label::kObject, Label::kUnseen}) {
      if (word == label_text(label)) return label;
    }
    value.fail("class must be tree, object or unseen");
  }
  const JsonValue& used(const char* key) {
    used_.push_back(key);
    return value_;
  }

  JsonSource source_;
  Json json_;
  JsonValue value_{json_, source_};
  std::vector<std::string> used_;
};

Correction correction_of(Line& line) {
  Correction c;
  c.number = line.integer("n", 1);
  c.utime = line.utime();
  c.who = line.text("who");
  c.kind = line.kind();
  const CorrectionShape& shape = correction_shape(c.kind);
  if (shape.trees_most > 0) c.targets = line.targets(shape.trees_least, shape.trees_most);
  if (shape.num_places > 0) c.places_map = line.places(shape.num_places);
  if (shape.has("new_id")) c.new_id = line.integer("new_id", 1);
  if (shape.has("class")) c.label = line.label();
  if (shape.has("width_m")) c.width_m = line.width_m();
  if (shape.has("row")) c.row = line.integer("row", 1);
  if (shape.has("name")) c.name = line.text("name");
  if (shape.has("position")) c.position = line.integer("position", 0);
  if (shape.has("of")) c.of = line.integer("of", 1);
  if (line.has("note")) c.note = line.text("note");
  if (c.kind == CorrectionKind::kNote && c.note.empty()) line.fail("the note is empty");
  line.require_all_used();
  return c;
}

constexpr std::size_t kMaxBytes = std::size_t{64} << 20;

std::string path_in(const std::string& folder) {
  return (fs::path(folder) / kCorrectionsFile).string();
}

[[noreturn]] void fail(const std::string& path, const char* what) {
  const int error = errno;
  throw SystemError(path + ": cannot " + what + " (" + std::strerror(error) + ")" +
                    (error == EACCES || error == EROFS ? "; check that you may write there" : ""));
}

/// The whole file; empty if there is none.
std::string text_of(const std::string& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return {};
  if (!fs::is_regular_file(status)) throw FileError(path + " is not a regular file; move it away");
  return read_file(path, kMaxBytes, "move it away");
}

/// The file, open and exclusively locked during the lifetime of this object.
class LockedFile {
 public:
  explicit LockedFile(std::string path) : path_(std::move(path)) {
    // The file may have been replaced or removed while waiting for the lock: then try again.
    while (!open_and_lock()) ::close(fd_);
  }
  ~LockedFile() {
    if (is_empty()) ::unlink(path_.c_str());  // nothing was written
    ::close(fd_);
  }
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;

  /// Replaces everything from `offset` on by `lines`, or leaves it unchanged when the disk is full.
  void write_from(std::size_t offset, const std::string& lines) {
    const auto end = static_cast<off_t>(offset);
    if (::ftruncate(fd_, end) != 0) fail(path_, "be written");
    try {
      write_fully(fd_, path_, lines.data(), lines.size());
      sync_file(fd_, path_);
    } catch (const FileError&) {
      (void)!::ftruncate(fd_, end);
      throw;
    }
  }

 private:
  bool open_and_lock() {
    fd_ = ::open(path_.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
    if (fd_ < 0) fail(path_, "be opened for writing");
    constexpr int kTries = 1000;
    constexpr useconds_t kPause_us = 10000;
    // On a file system without locks, none is used.
    for (int i = 0; ::flock(fd_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; ++i) {
      if (i >= kTries) {
        ::close(fd_);
        throw FileError(path_ + ": locked by another program for ten seconds; stop that program");
      }
      ::usleep(kPause_us);
    }
    struct stat mine {
    }, there{};
    return ::fstat(fd_, &mine) == 0 && ::stat(path_.c_str(), &there) == 0 &&
           mine.st_ino == there.st_ino && mine.st_dev == there.st_dev;
  }
  bool is_empty() const {
    struct stat status {};
    return ::fstat(fd_, &status) == 0 && S_ISREG(status.st_mode) && status.st_size == 0;
  }

  std::string path_;
  int fd_ = -1;
};

}  // namespace

bool CorrectionShape::has(std::string_view key) const {
  return (" " + std::string(fields) + " ").find(" " + std::string(key) + " ") != std::string::npos;
}

const CorrectionShape& correction_shape(CorrectionKind kind) {
  static const CorrectionShape kShapes[] = {{CorrectionKind::kDelete, 1, 1, 0, ""},
                                            {CorrectionKind::kAdd, 0, 0, 1, "new_id class width_m"},
                                            {CorrectionKind::kMove, 1, 1, 1, ""},
                                            {CorrectionKind::kClass, 1, 1, 0, "class"},
                                            {CorrectionKind::kMerge, 2, 100, 1, ""},
                                            {CorrectionKind::kSplit, 1, 1, 2, "new_id"},
                                            {CorrectionKind::kRowName, 0, 0, 0, "row name"},
                                            {CorrectionKind::kRenumber, 1, 1, 0, "row position"},
                                            {CorrectionKind::kNote, 1, 1, 0, ""},
                                            {CorrectionKind::kUndo, 0, 0, 0, "of"},
                                            {CorrectionKind::kRedo, 0, 0, 0, "of"}};
  return *std::find_if(std::begin(kShapes), std::end(kShapes),
                       [kind](const CorrectionShape& shape) { return shape.kind == kind; });
}

bool is_correction_text(const std::string& text) {
  if (text.size() > kCorrectionTextMax_bytes || printable_text(text) != text) return false;
  try {
    return !Json(text).dump().empty();
  } catch (const Json::exception&) {
    return false;  // not UTF-8
  }
}

std::string utc_text(std::int64_t utime) {
  const auto seconds = static_cast<std::time_t>(utime / 1000000);
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  char text[40];
  std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string correction_line(const Correction& c) {
  Json json{{"n", c.number}, {"when", utc_text(c.utime)}, {"who", c.who}};
  json["what"] = mapping::correction_word(c.kind);
  if (c.of != 0) json["of"] = c.of;
  for (const CorrectionTarget& target : c.targets) json["landmarks"].push_back(target_json(target));
  for (const Vector2d& p : c.places_map) {
    json["places_m"].push_back(Json::array({metres(p.x()), metres(p.y())}));
  }
  if (c.new_id != 0) json["new_id"] = c.new_id;
  const CorrectionShape& shape = correction_shape(c.kind);
  if (shape.has("class")) json["class"] = label_text(c.label);
  if (shape.has("width_m") && c.width_m > 0.0) json["width_m"] = metres(c.width_m);
  if (c.row != 0) json["row"] = c.row;
  if (shape.has("position")) json["position"] = c.position;
  if (shape.has("name")) json["name"] = c.name;
  if (!c.note.empty()) json["note"] = c.note;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

StoredCorrections parse_corrections(std::string_view text, const std::string& name) {
  StoredCorrections stored;
  std::size_t begin = 0;
  for (int line = 1; begin < text.size(); ++line) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string_view::npos) break;
    const std::string place = name + ":" + std::to_string(line);
    if (end - begin > kLineMax_bytes) throw FileError(place + ": the line is too long");
    Line fields(text.substr(begin, end - begin), place);
    Correction c = correction_of(fields);
    const std::int32_t last = stored.list.empty() ? 0 : stored.list.back().number;
    if (c.number <= last) fields.fail("n must increase from line to line");
    stored.list.push_back(std::move(c));
    begin = end + 1;
  }
  stored.num_unfinished_bytes = text.size() - begin;
  return stored;
}

StoredCorrections read_corrections(const std::string& folder) {
  const std::string path = path_in(folder);
  return parse_corrections(text_of(path), path);
}

std::vector<mapping::Correction> append_corrections(
    const std::string& folder,
    const std::function<std::vector<mapping::Correction>(const std::vector<mapping::Correction>&)>&
        make) {
  const std::string path = path_in(folder);
  LockedFile file(path);
  const std::string text = text_of(path);
  const StoredCorrections stored = parse_corrections(text, path);
  std::vector<mapping::Correction> added = make(stored.list);
  std::int32_t number = stored.list.empty() ? 0 : stored.list.back().number;
  std::string lines;
  for (mapping::Correction& c : added) {
    c.number = ++number;
    lines += correction_line(c);
  }
  parse_corrections(lines, path);  // throws if the lines could not be read again
  if (!lines.empty()) file.write_from(text.size() - stored.num_unfinished_bytes, lines);
  return added;
}

}  // namespace orchard::io
