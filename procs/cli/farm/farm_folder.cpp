// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm_folder.hpp"

#include <yaml-cpp/yaml.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "bus/process/process.hpp"
#include "cli/farm/farm.hpp"
#include "farm/drive_pieces.hpp"
#include "farm/farm_tasks.hpp"
#include "io/atomic_file.hpp"
#include "io/companion.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/map/corrections_file.hpp"
#include "text/date_problem.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kBytesPerMb = 1e6;
constexpr const char* kVersionFile = "work/version.txt";

/// Cache of file digests by path, size and modification time, stored between runs.
class DigestCache {
 public:
  explicit DigestCache(std::string path) : path_(std::move(path)) {
    std::ifstream file(path_);
    for (std::string line; std::getline(file, line);) {
      const std::size_t tab = line.find('\t');
      if (tab != std::string::npos && line.size() == tab + 1 + kDigestDigits) {
        by_key_[line.substr(0, tab)] = line.substr(tab + 1);
      }
    }
  }

  std::string digest(const std::string& inside, const std::string& path) {
    std::error_code error;
    const auto size = fs::file_size(path, error);
    const auto time = fs::last_write_time(path, error).time_since_epoch().count();
    const std::string key = inside + " " + std::to_string(size) + " " + std::to_string(time);
    const auto known = by_key_.find(key);
    const std::string digest = known != by_key_.end() ? known->second : digest_of_files({path});
    now_ += key + "\t" + digest + "\n";
    return digest;
  }

  /// Stores the digests requested in this run.
  void save() const { io::write_file_atomically(path_, now_); }

 private:
  static constexpr std::size_t kDigestDigits = 64;
  std::string path_;
  std::map<std::string, std::string> by_key_;
  std::string now_;
};

/// Why a name cannot be that of a block, a robot or a log; empty: it can.
std::string name_problem(const std::string& name) {
  if (name.empty() || name.front() == '.') return "a name may not be empty or begin with \".\"";
  if (name.find_first_of("/{}") != std::string::npos) {  // braces are Snakemake's wildcards
    return "a name may not have \"/\", \"{\" or \"}\"";
  }
  return io::is_correction_text(name) ? std::string()
                                      : "a name may only have printable characters in UTF-8";
}

void require_name(const std::string& option, const std::string& name) {
  const std::string problem = name_problem(name);
  if (!problem.empty()) {
    throw io::FileError(option + " " + printable_text(name) + ": " + problem + "; give another");
  }
}

farm::FarmSettings read_settings(const std::string& path) {
  farm::FarmSettings settings;
  try {
    const YAML::Node node = YAML::LoadFile(path);
    for (const auto& entry : node) {
      const auto key = entry.first.as<std::string>();
      if (key == "any_place") {
        settings.any_place = entry.second.as<bool>();
      } else if (key == "max_offset_m") {
        settings.max_offset_m = entry.second.as<double>();
      } else if (key == "publish_to") {
        settings.publish_to = entry.second.IsNull() ? "" : entry.second.as<std::string>();
      } else {
        throw io::FileError(path + ": " + key +
                            ": unknown key; the keys are any_place, max_offset_m and publish_to");
      }
    }
  } catch (const YAML::Exception& error) {
    throw io::FileError(path + ": " + error.what());
  }
  if (!(settings.max_offset_m >= 0.01 && settings.max_offset_m <= 100.0)) {
    throw io::FileError(path + ": max_offset_m: must be in [0.01, 100]");
  }
  return settings;
}

/// Reads logs/BLOCK/DATE/ROBOT/NAME.lcm; what is no drive gives a note.
class LogsReader {
 public:
  LogsReader(const FarmFolder& farm, FarmContent& content)
      : farm_(farm), content_(content), digests_(farm.path("work/digests.txt")) {}

  void read() {
    for (const std::string& block : folders("logs")) {
      for (const std::string& date : folders("logs/" + block)) {
        const std::string of_date = "logs/" + block + "/" + date;
        const std::string problem = date_problem(date);
        if (!problem.empty()) {
          ignore(of_date, date + " " + problem);
          continue;
        }
        for (const std::string& robot : folders(of_date)) {
          farm::Drive drive;
          drive.block = block, drive.date = date, drive.robot = robot;
          add_rig(drive);
          add_drives(drive);
        }
      }
    }
    digests_.save();
    if (num_hidden_ > 0) {
      content_.notes.push_back(first_hidden_ + (num_hidden_ == 1 ? " is" : " and other names are") +
                               " hidden and ignored");
    }
  }

 private:
  void ignore(const std::string& inside, const std::string& why) {
    content_.notes.push_back(printable_text(inside) + " is ignored: " + printable_text(why));
  }

  /// Names in a folder that can be used; hidden ones (of desktops, or a log that is being copied)
  /// are counted, others give a note.
  std::vector<std::string> names(const std::string& inside) {
    std::vector<std::string> usable;
    for (const std::string& name : io::folder_names(farm_.path(inside))) {
      const std::string path = inside + name;
      if (name.front() == '.') {
        if (num_hidden_++ == 0) first_hidden_ = printable_text(path);
      } else if (const std::string problem = name_problem(name); !problem.empty()) {
        ignore(path, problem + "; rename it");
      } else {
        usable.push_back(name);
      }
    }
    return usable;
  }

  std::vector<std::string> folders(const std::string& inside) {
    std::vector<std::string> found;
    for (const std::string& name : names(inside + "/")) {
      if (fs::is_directory(farm_.path(inside + "/" + name))) {
        found.push_back(name);
      } else {
        ignore(inside + "/" + name, "logs are stored as logs/BLOCK/DATE/ROBOT/NAME.lcm");
      }
    }
    return found;
  }

  void add_rig(farm::Drive& drive) {
    const std::string rig = "rigs/" + drive.robot + ".yaml";
    if (!fs::is_regular_file(farm_.path(rig))) return;
    if (rig_digests_[rig].empty()) rig_digests_[rig] = digest_of_files({farm_.path(rig)});
    drive.rig_path = rig;
    drive.rig_digest = rig_digests_[rig];
  }

  /// Adds the drives of one robot on one date.
  void add_drives(const farm::Drive& of_robot) {
    const std::string inside =
        "logs/" + of_robot.block + "/" + of_robot.date + "/" + of_robot.robot + "/";
    std::vector<std::string> files;
    for (const std::string& name : names(inside)) {
      if (farm::is_log_name(name) && fs::is_regular_file(farm_.path(inside + name))) {
        files.push_back(name);
      } else {
        ignore(inside + name, "the name of a log is NAME.lcm");
      }
    }
    for (const farm::DrivePieces& pieces : farm::drives_of_files(files)) {
      farm::Drive drive = of_robot;
      drive.name = pieces.name;
      std::string digest_text;
      for (const std::string& file : pieces.files) {
        const std::string path = inside + file;
        drive.log_paths.push_back(path);
        digest_text += digests_.digest(path, farm_.path(path)) + "\n";
        drive.num_bytes += fs::file_size(farm_.path(path));
      }
      if (!pieces.missing.empty()) {
        content_.notes.push_back(inside + pieces.files.front() + " to " + pieces.files.back() +
                                 " are one drive, whose pieces " + pieces.missing +
                                 " are missing; separate drives need names without such a number");
      }
      drive.log_digest = farm::sha256_hex(digest_text);
      content_.drives.push_back(std::move(drive));
    }
  }

  const FarmFolder& farm_;
  FarmContent& content_;
  DigestCache digests_;
  std::map<std::string, std::string> rig_digests_;
  std::string first_hidden_;
  int num_hidden_ = 0;
};

double km_of(const std::string& trajectory_path) {
  std::ifstream file(trajectory_path);
  std::string line;
  std::getline(file, line);
  double way_m = 0.0, last_x = 0.0, last_y = 0.0;
  bool has_last = false;
  while (std::getline(file, line)) {
    double utime = 0.0, x = 0.0, y = 0.0;
    char comma = 0;
    std::istringstream fields(line);
    fields.imbue(std::locale::classic());
    if (!(fields >> utime >> comma >> x >> comma >> y)) break;
    if (has_last) way_m += std::hypot(x - last_x, y - last_y);
    last_x = x, last_y = y, has_last = true;
  }
  return 1e-3 * way_m;
}

double trees_of(const std::string& map_path) {
  std::ifstream file(map_path);
  double num = 0.0;
  for (std::string line; std::getline(file, line);) num += line.find(",tree,") < 12 ? 1.0 : 0.0;
  return num;
}

}  // namespace

std::string corrections_line(const std::string& folder) {
  const std::string path = folder + "/" + io::kCorrectionsFile;
  return fs::exists(path) ? "corrections " + digest_of_files({path}) : std::string();
}

std::string digest_of_files(const std::vector<std::string>& paths) {
  farm::Sha256 digest;
  std::vector<char> buffer(1 << 20);
  for (const std::string& path : paths) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw io::FileError(path + " cannot be read");
    while (file) {
      file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
      digest.add(buffer.data(), static_cast<std::size_t>(file.gcount()));
    }
    if (file.bad()) throw io::FileError(path + " could not be read completely");
  }
  return digest.hex();
}

FarmFolder::FarmFolder(std::string root) : root_(std::move(root)) {
  if (!fs::is_regular_file(path("farm.yaml")) || !fs::is_directory(path("logs"))) {
    throw io::FileError(
        root_ +
        " is not a farm (it lacks farm.yaml or logs/); create one with `orchard farm init " +
        root_ + "`");
  }
}

/// Digest of the bytes of all that makes a result: the programs that the steps call, and the steps.
std::string FarmFolder::programs() const {
  const std::string folder = io::program_folder() + "/";
  return digest_of_files({folder + "orchard", folder + "orchard-maps", path("Snakefile")});
}

void FarmFolder::adopt_programs(bool keep_others) const {
  if (keep_others && fs::exists(path(kVersionFile))) return;
  io::write_file_atomically(path(kVersionFile), programs() + "\n");
}

FarmContent FarmFolder::read() const {
  FarmContent content;
  content.settings = read_settings(path("farm.yaml"));
  fs::create_directories(path("work"));
  const std::string now = programs();
  std::ifstream adopted(path(kVersionFile));
  if (!std::getline(adopted, content.settings.version)) content.settings.version = now;
  if (content.settings.version != now) {
    content.notes.push_back(
        "the programs or the Snakefile have changed since these results were made; `orchard farm "
        "run` makes all of them anew, --keep-version keeps them and makes only what is missing");
  }
  LogsReader(*this, content).read();
  return content;
}

void FarmFolder::write_tasks(const FarmContent& content, const std::vector<farm::FarmTask>& tasks,
                             const farm::CostFit& costs) const {
  using nlohmann::ordered_json;
  ordered_json json;
  json["any_place"] = content.settings.any_place;
  json["max_offset_m"] = content.settings.max_offset_m;
  json["publish_to"] = content.settings.publish_to;
  json["tasks"] = ordered_json::object();
  for (const farm::FarmTask& task : tasks) {
    double log_mb = 0.0;
    for (const farm::Drive& drive : task.drives) {
      log_mb += static_cast<double>(drive.num_bytes) / kBytesPerMb;
    }
    ordered_json entry{{"kind", farm::kind_text(task.kind)}, {"needs", task.needs}};
    if (task.kind == farm::TaskKind::kReport) {
      entry["title"] = task.drives.front().block + " " + task.drives.front().date;
    } else if (task.kind == farm::TaskKind::kPublish) {
      entry["block"] = task.drives.front().block;
      entry["date"] = task.drives.front().date;
    } else if (task.kind == farm::TaskKind::kDate || task.kind == farm::TaskKind::kChanges) {
      entry["earlier"] = task.earlier;
    } else {
      log_mb = static_cast<double>(task.drives.front().num_bytes) / kBytesPerMb;
      entry["logs"] = task.drives.front().log_paths;
      entry["rig"] = task.drives.front().rig_path;
    }
    entry["of"] = ordered_json::array();
    for (const farm::Drive& drive : task.drives) entry["of"].push_back(drive.title());
    // 1.5 times the expected memory; a step that fails requests more.
    entry["memory_mb"] =
        std::ceil(200.0 + 1.5 * (costs.ask_mb.at_least + costs.ask_mb.per_mb * log_mb));
    entry["time_s"] = std::ceil(60.0 + 5.0 * (costs.ask_s.at_least + costs.ask_s.per_mb * log_mb));
    json["tasks"][task.name] = std::move(entry);
  }
  io::write_file_atomically(path("work/tasks.json"), json.dump(1) + "\n");
}

std::vector<farm::FarmTask> FarmFolder::tasks_of(const FarmContent& content) const {
  return farm::tasks_of(content.drives, content.settings,
                        [this](const std::string& name) { return edits_of(name); });
}

std::string FarmFolder::edits_of(const std::string& task) const {
  const std::string now = corrections_line(path("results/" + task));
  std::ifstream file(path("results/" + task + "/state.txt"));
  std::string line, made_with;
  std::getline(file, line);
  std::getline(file, made_with);
  return now == made_with ? std::string() : now;
}

std::optional<TaskState> FarmFolder::state_of(const std::string& task) const {
  std::ifstream file(path("results/" + task + "/state.txt"));
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  const std::string set_aside = "set aside: ";
  if (line.rfind(set_aside, 0) == 0) return TaskState{false, line.substr(set_aside.size())};
  return TaskState{true, {}};
}

std::vector<farm::CostSample> FarmFolder::costs(const std::vector<farm::FarmTask>& tasks) const {
  std::vector<farm::CostSample> samples;
  for (const farm::FarmTask& task : tasks) {
    if (task.kind != farm::TaskKind::kMap) continue;
    std::ifstream file(path("work/cost/" + task.name + ".txt"));
    farm::CostSample sample;
    double wall_s = 0.0;
    const auto state = state_of(task.name);
    if (!state || !state->is_good) continue;
    if (!(file >> wall_s >> sample.processor_s >> sample.memory_mb)) continue;
    sample.way_km = km_of(path("results/" + task.name + "/trajectory.csv"));
    sample.num_trees = trees_of(path("results/" + task.name + "/map.csv"));
    sample.log_mb = static_cast<double>(task.drives.front().num_bytes) / kBytesPerMb;
    samples.push_back(sample);
  }
  return samples;
}

int run_farm_init(const FarmInitOptions& options) {
  for (const char* folder : {"logs", "rigs", "plans"})
    io::make_folder(options.folder + "/" + folder);
  for (int i = 0; i < kNumFarmFiles; ++i) {
    const std::string path = options.folder + "/" + kFarmFiles[i].name;
    const bool is_users = std::string(kFarmFiles[i].name) == "farm.yaml";
    if (fs::exists(path) && (is_users || !options.renew)) {
      std::printf("%s exists and was not changed\n", path.c_str());
      continue;
    }
    io::make_folder(fs::path(path).parent_path().string());
    io::write_file_atomically(path, kFarmFiles[i].text);
    if (path.size() > 3 && path.substr(path.size() - 3) == ".sh") {
      fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                      fs::perm_options::add);
    }
  }
  std::printf(
      "farm created in %s. Put logs into logs/BLOCK/DATE/ROBOT/ (or run `orchard farm add %s LOG "
      "--block B --date D --robot R`),\n"
      "  and rigs that replace those stored in the logs into rigs/ROBOT.yaml; then run `orchard "
      "farm run %s`\n",
      options.folder.c_str(), options.folder.c_str(), options.folder.c_str());
  return bus::kExitOk;
}

int run_farm_add(const FarmAddOptions& options) {
  const FarmFolder farm(options.folder);
  require_name("--block", options.block);
  require_name("--robot", options.robot);
  const std::string problem = date_problem(options.date);
  if (!problem.empty()) throw io::FileError("--date " + options.date + " " + problem);
  const std::string folder =
      farm.path("logs/" + options.block + "/" + options.date + "/" + options.robot);
  for (const std::string& log : options.log_paths) {
    const std::string name = fs::path(log).filename().string();
    if (!name_problem(name).empty() || !farm::is_log_name(name)) {
      throw io::FileError(log +
                          ": not the name of a log in a farm; rename it to NAME.lcm (parts of a "
                          "split log: NAME-000.lcm ... or NAME.lcm.00 ...)");
    }
    const std::string place = folder + "/" + name;
    if (fs::exists(place)) {
      if (digest_of_files({place}) != digest_of_files({log})) {
        throw io::FileError(place + " exists already and differs from " + log);
      }
      std::printf("%s exists already with the same content\n", place.c_str());
      continue;
    }
    io::make_folder(folder);
    // Atomic, so that a concurrent run of the farm never reads an incomplete log.
    io::replace_file_atomically(place, [&](const std::string& temporary) {
      std::error_code error;
      fs::copy_file(log, temporary, fs::copy_options::overwrite_existing, error);
      if (error) throw io::FileError(log + " could not be copied (" + error.message() + ")");
    });
    std::printf("%s\n", place.c_str());
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
