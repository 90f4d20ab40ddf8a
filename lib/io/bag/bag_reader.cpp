// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/bag_reader.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/bag/record_bag.hpp"
#include "io/file_error.hpp"
#include "io/unpacking_budget.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxLosses = 100;
constexpr std::size_t kMaxTopics = 10000;

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

/// Opens the database read-only and restricted: its content must not execute code or access other
/// files, and no row may exhaust the memory.
Database open(const std::string& path) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(path.c_str(), &raw, SQLITE_OPEN_READONLY, nullptr);
  Database database(raw, sqlite3_close);
  if (code != SQLITE_OK) {
    throw FileError(path + ": cannot be opened as an SQLite database" +
                    (raw ? std::string(" (") + sqlite3_errmsg(raw) + ")" : ""));
  }
  sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
  sqlite3_limit(raw, SQLITE_LIMIT_LENGTH, static_cast<int>(BagReader::kMaxMessageBytes) + 1024);
  return database;
}

Statement prepare(sqlite3* database, const std::string& path, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  if (sqlite3_prepare_v2(database, sql, -1, &raw, nullptr) != SQLITE_OK) {
    throw FileError(path + ": not a bag of rosbag2, or damaged (" + sqlite3_errmsg(database) + ")");
  }
  return Statement(raw, sqlite3_finalize);
}

/// The database if its messages are stored, not made by it while they are read. Throws FileError.
Database open_plain(const std::string& path) {
  Database database = open(path);
  const Statement made =
      prepare(database.get(), path,
              "SELECT 1 FROM pragma_table_list('messages') WHERE type != 'table' UNION ALL "
              "SELECT 1 FROM pragma_table_xinfo('messages') WHERE hidden > 1");
  if (sqlite3_step(made.get()) == SQLITE_ROW) {
    throw FileError(path +
                    ": its messages are not stored but computed; rosbag2 writes no such bag");
  }
  return database;
}

std::string text(sqlite3_stmt* row, int column) {
  const unsigned char* begin = sqlite3_column_text(row, column);
  const int size = sqlite3_column_bytes(row, column);
  return begin ? std::string(reinterpret_cast<const char*>(begin), static_cast<std::size_t>(size))
               : std::string();
}

/// Reads a bag in rosbag2's sqlite3 storage: tables `topics` and `messages`; single messages may be
/// zstd-compressed. A row that SQLite cannot read ends the reading and is listed in losses().
class SqliteBag : public BagReader {
 public:
  /// Throws FileError when the file is not a database or lacks these tables.
  SqliteBag(const std::string& path, const std::function<void()>& on_progress)
      : path_(path),
        file_bytes_(fs::file_size(path)),
        on_progress_(on_progress),
        database_(open_plain(path)),
        all_(prepare(database_.get(), path,
                     "SELECT rowid, topic_id, timestamp, data FROM messages ORDER BY rowid")),
        one_(prepare(database_.get(), path,
                     "SELECT rowid, topic_id, timestamp, data FROM messages WHERE rowid = ?")) {
    read_topics();
  }

  std::optional<BagMessage> next() override {
    while (!is_done_) {
      on_progress_();
      const int code = sqlite3_step(all_.get());
      if (code != SQLITE_ROW) {
        is_done_ = true;
        if (code != SQLITE_DONE) {
          lose("after row " + std::to_string(row_) + " of " + std::to_string(num_rows_) +
               " no more rows can be read (" + sqlite3_errmsg(database_.get()) + ")");
        }
        break;
      }
      row_ = static_cast<std::uint64_t>(sqlite3_column_int64(all_.get(), 0));
      auto message = message_of(all_.get());
      if (!message) continue;
      read_bytes_ += message->size;
      if (is_plausibly_packed(file_bytes_, read_bytes_)) return message;
      lose("from row " + std::to_string(row_) +
           " on nothing is read, because the messages have over " +
           std::to_string(read_bytes_ >> 20) + " MB: no recording packs so well");
      is_done_ = true;
    }
    return std::nullopt;
  }

  std::optional<BagMessage> at(const BagPlace& place) override {
    sqlite3_stmt* statement = one_.get();
    sqlite3_reset(statement);
    sqlite3_bind_int64(statement, 1, static_cast<sqlite3_int64>(place.record));
    if (sqlite3_step(statement) != SQLITE_ROW) return std::nullopt;
    return message_of(statement);
  }

  const std::vector<BagTopic>& topics() const override { return topics_; }
  const std::vector<std::string>& losses() const override { return losses_; }
  std::uint64_t position() const override { return row_; }
  std::uint64_t size() const override { return num_rows_; }

 private:
  void read_topics() {
    const Statement rows =
        prepare(database_.get(), path_, "SELECT id, name, type, serialization_format FROM topics");
    int code = SQLITE_DONE;
    while (topics_.size() < kMaxTopics && (code = sqlite3_step(rows.get())) == SQLITE_ROW) {
      BagTopic topic;
      topic.name = text(rows.get(), 1);
      topic.type = text(rows.get(), 2);
      topic.wire = ros::Wire::kCdr;
      topic.is_known_wire = text(rows.get(), 3) == "cdr";
      topic_of_id_[sqlite3_column_int64(rows.get(), 0)] = topics_.size();
      topics_.push_back(std::move(topic));
    }
    if (code != SQLITE_DONE && code != SQLITE_ROW) {
      throw FileError(path_ + ": its topics cannot be read (" + sqlite3_errmsg(database_.get()) +
                      ")");
    }
    const Statement count = prepare(database_.get(), path_, "SELECT max(rowid) FROM messages");
    if (sqlite3_step(count.get()) == SQLITE_ROW) {
      num_rows_ = static_cast<std::uint64_t>(
          std::max<sqlite3_int64>(0, sqlite3_column_int64(count.get(), 0)));
    }
  }

  void lose(const std::string& what) {
    if (losses_.size() < kMaxLosses) losses_.push_back(what);
  }

  std::optional<BagMessage> message_of(sqlite3_stmt* statement) {
    BagMessage message;
    message.place.record = static_cast<std::uint64_t>(sqlite3_column_int64(statement, 0));
    const std::string name = "row " + std::to_string(message.place.record) + " of messages: ";
    const auto topic = topic_of_id_.find(sqlite3_column_int64(statement, 1));
    if (topic == topic_of_id_.end()) {
      lose(name + "its topic is not defined");
      return std::nullopt;
    }
    message.topic = topic->second;
    message.utime = sqlite3_column_int64(statement, 2) / 1000;
    message.data = static_cast<const std::uint8_t*>(sqlite3_column_blob(statement, 3));
    message.size = static_cast<std::size_t>(sqlite3_column_bytes(statement, 3));
    if (message.data == nullptr) message.size = 0;
    if (!is_zstd(message.data, message.size)) return message;
    unpacked_.resize(zstd_size(message.data, message.size, kMaxMessageBytes));
    const std::string mistake = unpacked_.empty()
                                    ? std::string("its size is unknown, or above 64 MB")
                                    : unpack("zstd", message.data, message.size, unpacked_);
    if (!mistake.empty()) {
      lose(name + mistake);
      return std::nullopt;
    }
    message.data = unpacked_.data();
    message.size = unpacked_.size();
    return message;
  }

  std::string path_;
  std::uint64_t file_bytes_;
  std::uint64_t read_bytes_ = 0;  ///< unpacked, by next()
  std::function<void()> on_progress_;
  Database database_;
  Statement all_, one_;
  std::map<sqlite3_int64, std::size_t> topic_of_id_;
  std::vector<BagTopic> topics_;
  std::vector<std::string> losses_;
  std::vector<std::uint8_t> unpacked_;
  std::uint64_t row_ = 0, num_rows_ = 0;
  bool is_done_ = false;
};

enum class Format { kNone, kRosbag, kMcap, kSqlite };

Format format_of(const std::string& path) {
  if (!fs::is_regular_file(path)) return Format::kNone;
  std::ifstream file(path, std::ios::binary);
  std::array<char, 16> begin{};
  file.read(begin.data(), begin.size());
  const std::string_view magic(begin.data(), static_cast<std::size_t>(file.gcount()));
  const auto is = [magic](std::string_view known) {
    return magic.substr(0, known.size()) == known;
  };
  if (is("#ROSBAG V2.0\n")) return Format::kRosbag;
  if (is("\x89MCAP0\r\n")) return Format::kMcap;
  if (is(std::string_view("SQLite format 3\0", 16))) return Format::kSqlite;
  return Format::kNone;
}

}  // namespace

bool is_bag(const std::string& path) { return format_of(path) != Format::kNone; }

std::unique_ptr<BagReader> open_bag(const std::string& path,
                                    const std::function<void()>& on_progress) {
  const Format format = format_of(path);
  if (format == Format::kNone) {
    throw FileError(path +
                    ": not a supported bag; give a rosbag 2.0, MCAP or sqlite3 (rosbag2) bag");
  }
  if (format == Format::kSqlite) return std::make_unique<SqliteBag>(path, on_progress);
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*file) throw FileError(path + ": cannot be opened");
  return std::make_unique<RecordBag>(
      std::move(file), format == Format::kRosbag ? make_rosbag_format() : make_mcap_format(),
      on_progress);
}

std::vector<std::string> bag_files(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string path = entry.path().string();
    const std::string extension = entry.path().extension().string();
    if ((extension == ".zstd" || extension == ".zst") &&
        fs::exists(fs::path(folder) / "metadata.yaml")) {
      throw FileError(path + " is compressed as a file; decompress it first: zstd -d " + path);
    }
    const bool is_named = extension == ".db3" || extension == ".mcap" || extension == ".bag";
    if (is_named && is_bag(path)) files.push_back(path);
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace orchard::io
