// SPDX-License-Identifier: BSD-3-Clause
#include <sys/stat.h>
#include <yaml-cpp/yaml.h>
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "bus/replay/logged_rig.hpp"
#include "cli/farm/farm_folder.hpp"
#include "farm/drive_pieces.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config.hpp"
#include "io/config/config_difference.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/map/corrections_file.hpp"
#include "text/date_problem.hpp"
#include "text/encoded_text.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kRigBytesMax = std::size_t{1} << 20;  ///< derived: as of every rig

/// What a rig tells a farm.
struct RigFacts {
  std::string map_file;  ///< of mode prior_map; empty: none
  double max_offset_m = farm::Drive::kMaxOffset_m;
};

RigFacts facts_of(const pose::PoseConfig& config) {
  using pose::PoseMode;
  const bool is_of_fixes =
      config.mode == PoseMode::kFixes || config.mode == PoseMode::kFixesAndOdometry;
  return {config.mode == PoseMode::kPriorMap ? config.prior_map.map_file : std::string(),
          is_of_fixes ? farm::Drive::kMaxOffsetOfFixes_m : farm::Drive::kMaxOffset_m};
}

/// Of the first rig that a log holds; of none if it cannot be used.
RigFacts facts_of_log(const std::string& path) {
  try {
    const auto rigs = bus::read_logged_rigs(io::LogPaths({path}));
    if (!rigs.empty()) return facts_of(io::parse_recorded_config(rigs[0].yaml, path).config.pose);
  } catch (const io::FileError&) {  // `orchard map` tells what is wrong
  } catch (const io::ConfigError&) {
  }
  return {};
}

/// A rig as the keys that reach a map and are not as by default: without comments, in one order.
std::string meaning_of(const io::Config& config) {
  const std::string all = io::effective_config(config);
  YAML::Node root(YAML::NodeType::Map);
  for (const auto& d : io::config_differences(io::effective_config(io::Config()), all)) {
    YAML::Node at = root;
    std::istringstream words(d.key);
    for (std::string word; std::getline(words, word, '.');) at.reset(at[word]);
    at = YAML::Load(d.b);
  }
  return YAML::Dump(root) + "\n";
}

/// What is known of the files of a farm, stored between runs.
class FileFacts {
 public:
  explicit FileFacts(const FarmFolder& farm) : farm_(farm), path_(farm.path("work/digests.json")) {
    std::ifstream file(path_);
    known_ = json::parse(file, nullptr, false);
    if (!known_.is_object()) known_ = json::object();
  }

  /// SHA-256 of a file, and for a log what its rig tells. Computed anew where size, time of
  /// change or the file itself are others. Throws io::SystemError.
  json of(const std::string& inside, bool is_log) {
    const std::string path = (fs::path(farm_.root()) / inside).string();
    const std::string key = inside + " " + identity_of(path);
    struct stat at {};
    ::stat(path.c_str(), &at);
    json facts = known_.value(key, json::object());
    if (!facts.contains("digest")) {
      facts["digest"] = digest_of_files({path});
      if (is_log) {
        const RigFacts rig = facts_of_log(path);
        facts["map_file"] = rig.map_file, facts["max_offset_m"] = rig.max_offset_m;
      }
    }
    if (at.st_ctim.tv_sec + kTimeStep_s < std::time(nullptr)) now_[key] = facts;
    return facts;
  }

  /// Stores what was asked for; without write access the next run computes it again.
  void save() const {
    try {
      io::write_file_atomically(path_, now_.dump(0, ' ', false, json::error_handler_t::replace));
    } catch (const io::SystemError&) {
    }
  }

 private:
  /// physical: the coarsest step of file times (FAT); a younger file may change without a trace.
  static constexpr std::time_t kTimeStep_s = 2;

  const FarmFolder& farm_;
  std::string path_;
  json known_, now_ = json::object();
};

farm::FarmSettings read_settings(const std::string& path) {
  farm::FarmSettings settings;
  try {
    const YAML::Node node = YAML::LoadFile(path);
    for (const auto& entry : node) {
      const auto key = entry.first.as<std::string>();
      if (key == "any_place") {
        settings.any_place = entry.second.as<bool>();
      } else if (key == "max_offset_m") {
        if (!entry.second.IsNull()) settings.max_offset_m = entry.second.as<double>();
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
  const double max_offset_m = settings.max_offset_m.value_or(1.0);
  if (!(max_offset_m >= 0.01 && max_offset_m <= 100.0)) {
    throw io::FileError(path + ": max_offset_m: must be in [0.01, 100]");
  }
  return settings;
}

/// Reads logs/BLOCK/DATE/ROBOT/NAME.lcm; what is no drive gives a note.
class LogsReader {
 public:
  LogsReader(const FarmFolder& farm, FarmContent& content)
      : farm_(farm), content_(content), facts_(farm) {}

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
    facts_.save();
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

  /// Takes the rig of the drive's robot, if it has one, by its meaning; the steps read a copy.
  void add_rig(farm::Drive& drive) {
    const std::string path = farm_.path("rigs/" + drive.robot + ".yaml");
    if (!fs::is_regular_file(path)) return;
    std::string copy = io::read_file(path, kRigBytesMax, "give a rig");
    try {
      const io::Config config = io::parse_config(copy, path);
      copy = meaning_of(config);
      add_named_files(facts_of(config.pose), drive);
    } catch (const io::ConfigError&) {  // `orchard map` tells all that is wrong with it
    }
    const std::string digest = farm::sha256_hex(copy);
    drive.rig_path = "work/rigs/" + digest + ".yaml";
    drive.files[drive.rig_path] = digest;
    content_.rig_copies[drive.rig_path] = std::move(copy);
  }

  /// Files that a rig names: of a folder all, of a file also those beside it of the same name.
  void add_named_files(const RigFacts& rig, farm::Drive& drive) {
    drive.max_offset_m = rig.max_offset_m;
    if (rig.map_file.empty()) return;
    const fs::path named(rig.map_file), there = fs::path(farm_.root()) / named;
    const bool is_folder = fs::is_directory(there);
    const fs::path folder = is_folder ? named : named.parent_path();
    if (!fs::exists(there)) drive.files[rig.map_file] = "";
    for (const std::string& name : io::folder_names((fs::path(farm_.root()) / folder).string())) {
      const std::string inside = (folder / name).string();
      if (!is_folder && fs::path(name).stem() != named.stem()) continue;
      if (!fs::is_regular_file(fs::path(farm_.root()) / inside)) continue;
      drive.files[inside] = facts_.of(inside, false)["digest"].get<std::string>();
    }
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
      std::string digests;
      for (const std::string& file : pieces.files) {
        const json facts = facts_.of(inside + file, true);
        drive.log_paths.push_back(inside + file);
        drive.num_bytes += fs::file_size(farm_.path(inside + file));
        const auto digest = facts["digest"].get<std::string>();
        digests += digest + "\n";
        drive.files[inside + file] = digest;
        if (of_robot.rig_path.empty() && &file == &pieces.files.front()) {
          add_named_files({facts["map_file"], facts["max_offset_m"]}, drive);
        }
      }
      drive.log_digest = farm::sha256_hex(digests);
      std::string of_rig;
      for (const auto& [path, digest] : drive.files) {
        if (std::count(drive.log_paths.begin(), drive.log_paths.end(), path) > 0) continue;
        of_rig += path + " " + digest + "\n";
      }
      drive.rig_digest = of_rig.empty() ? "" : farm::sha256_hex(of_rig);
      if (!pieces.missing.empty()) {
        content_.notes.push_back(inside + pieces.files.front() + " to " + pieces.files.back() +
                                 " are one drive, whose pieces " + pieces.missing +
                                 " are missing; separate drives need names without such a number");
      }
      content_.drives.push_back(std::move(drive));
    }
  }

  const FarmFolder& farm_;
  FarmContent& content_;
  FileFacts facts_;
  std::string first_hidden_;
  int num_hidden_ = 0;
};

}  // namespace

/// Why a name cannot be that of a block, a robot or a log; empty: it can.
std::string name_problem(const std::string& name) {
  if (name.empty() || name.front() == '.') return "a name may not be empty or begin with \".\"";
  if (name.find_first_of("/{}") != std::string::npos) {  // braces are Snakemake's wildcards
    return "a name may not have \"/\", \"{\" or \"}\"";
  }
  return io::is_correction_text(name) ? std::string()
                                      : "a name may only have printable characters in UTF-8";
}

FarmContent read_content(const FarmFolder& farm) {
  FarmContent content;
  content.settings = read_settings(farm.path("farm.yaml"));
  LogsReader(farm, content).read();
  return content;
}

}  // namespace orchard::cli
