// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm_folder.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "farm/farm_tasks.hpp"
#include "io/atomic_file.hpp"
#include "io/companion.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/map/corrections_file.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kBytesPerMb = 1e6;
const std::string kFileWord = "file ";
constexpr const char* kVersionFile = "work/version.txt";

nlohmann::json read_json(const std::string& path) {
  std::ifstream file(path);
  return nlohmann::json::parse(file, nullptr, false);
}

[[noreturn]] void refuse_input(const std::string& what, const char* advice) {
  throw io::SystemError(what + "; " + advice);
}

}  // namespace

std::string corrections_line(const std::string& folder) {
  const std::string path = folder + "/" + io::kCorrectionsFile;
  return fs::exists(path) ? "corrections " + digest_of_files({path}) : std::string();
}

std::string last_line(const std::string& path) {
  std::ifstream file(path);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

std::string digest_of_files(const std::vector<std::string>& paths) {
  farm::Sha256 digest;
  std::vector<char> buffer(1 << 20);
  for (const std::string& path : paths) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw io::SystemError(path + " cannot be read");
    while (file) {
      file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
      digest.add(buffer.data(), static_cast<std::size_t>(file.gcount()));
    }
    if (file.bad()) throw io::SystemError(path + " could not be read completely");
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

std::string FarmFolder::programs() const {
  const std::string folder = io::program_folder() + "/";
  return digest_of_files({folder + "orchard", folder + "orchard-maps", path("Snakefile")});
}

void FarmFolder::adopt_programs(bool keep_others) const {
  if (keep_others && fs::exists(path(kVersionFile))) return;
  io::write_file_atomically(path(kVersionFile), programs() + "\n");
}

FarmContent FarmFolder::read() const {
  FarmContent content = read_content(*this);
  const std::string now = programs();
  std::ifstream adopted(path(kVersionFile));
  if (!std::getline(adopted, content.settings.version)) content.settings.version = now;
  if (content.settings.version != now) {
    content.notes.push_back(
        "the programs or the Snakefile have changed since these results were made; `orchard farm "
        "run` makes all of them anew, --keep-version keeps them and makes only what is missing");
  }
  return content;
}

void FarmFolder::write_tasks(const FarmContent& content, const std::vector<farm::FarmTask>& tasks,
                             const farm::CostFit& costs) const {
  using nlohmann::ordered_json;
  io::make_folder(path("work/rigs"));
  for (const auto& [copy, text] : content.rig_copies) {
    if (!fs::exists(path(copy))) io::write_file_atomically(path(copy), text);
  }
  ordered_json json;
  json["programs"] = programs();
  json["any_place"] = content.settings.any_place;
  json["publish_to"] = content.settings.publish_to;
  json["tasks"] = ordered_json::object();
  for (const farm::FarmTask& task : tasks) {
    double log_mb = 0.0;
    for (const farm::Drive& drive : task.drives) {
      log_mb += static_cast<double>(drive.num_bytes) / kBytesPerMb;
    }
    ordered_json entry{
        {"kind", farm::kind_text(task.kind)}, {"needs", task.needs}, {"edits", task.edits}};
    if (task.kind == farm::TaskKind::kReport) {
      entry["title"] = task.drives.front().block + " " + task.drives.front().date;
    } else if (task.kind == farm::TaskKind::kPublish) {
      entry["block"] = task.drives.front().block;
      entry["date"] = task.drives.front().date;
    } else if (task.kind == farm::TaskKind::kDate || task.kind == farm::TaskKind::kChanges) {
      entry["earlier"] = task.earlier;
      entry["max_offset_m"] = task.max_offset_m;
    } else {
      log_mb = static_cast<double>(task.drives.front().num_bytes) / kBytesPerMb;
      entry["logs"] = task.drives.front().log_paths;
      entry["rig"] = task.drives.front().rig_path;
      entry["files"] = task.drives.front().files;
    }
    entry["of"] = ordered_json::array();
    for (const farm::Drive& drive : task.drives) entry["of"].push_back(drive.title());
    // 1.5 times the expected memory; a step that fails requests more.
    entry["memory_mb"] = std::ceil(200.0 + 1.5 * costs.memory_mb.of(log_mb));
    entry["time_s"] = std::ceil(60.0 + 5.0 * costs.time_s.of(log_mb));
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
  const auto state = state_of(task);
  return now == (state ? state->corrections : std::string()) ? std::string() : "edited: " + now;
}

/// As written by `farm step`: the state, the corrections, and "file DIGEST NAME" for every file.
std::optional<TaskState> FarmFolder::state_of(const std::string& task) const {
  std::ifstream file(path("results/" + task + "/state.txt"));
  std::string line;
  if (!std::getline(file, line)) return std::nullopt;
  const std::string set_aside = "set aside: ";
  TaskState state;
  state.is_good = line.rfind(set_aside, 0) != 0;
  if (!state.is_good) state.reason = line.substr(set_aside.size());
  while (std::getline(file, line)) {
    const std::size_t name = line.find(' ', kFileWord.size());
    if (line.rfind(kFileWord, 0) != 0 || name == std::string::npos) {
      state.corrections = line;
    } else {
      state.files[line.substr(name + 1)] = line.substr(kFileWord.size(), name - kFileWord.size());
    }
  }
  return state;
}

std::string FarmFolder::damage_of(const std::string& task) const {
  const auto state = state_of(task);
  if (!state) return "is not there";
  for (const auto& [name, digest] : state->files) {
    const std::string file = path("results/" + task + "/" + name);
    if (!fs::exists(file)) return name + " is missing";
    if (digest_of_files({file}) != digest) return name + " was altered";
  }
  return {};
}

void FarmFolder::require_inputs(const std::string& task) const {
  constexpr const char* kAgain = "run `orchard farm run` again, which makes what it is now";
  const auto list = read_json(path("work/tasks.json"));
  if (!list.is_object() || !list["tasks"].contains(task)) {
    refuse_input(task + " is not in the list of steps, work/tasks.json", kAgain);
  }
  if (list["programs"] != programs()) {
    refuse_input("the programs in " + io::program_folder() +
                     " or the Snakefile are not those of "
                     "`orchard farm run`",
                 "install the same programs on all machines, or run it again");
  }
  const auto& entry = list["tasks"][task];
  const auto files = entry.value("files", nlohmann::json::object());
  for (const auto& [name, digest] : files.items()) {
    const std::string file = (fs::path(root_) / name).string();
    const bool is_absent = digest == "" && !fs::exists(file);
    if (!is_absent && digest_of_files({file}) != digest) {
      refuse_input(file + " has changed since `orchard farm run` began", kAgain);
    }
  }
  for (const auto& [date, edits] : entry["edits"].items()) {
    if (edits_of(date) != edits) {
      refuse_input("the corrections of results/" + date + " have changed", kAgain);
    }
  }
  for (const char* kind : {"needs", "earlier"}) {
    for (const auto& need : entry.value(kind, std::vector<std::string>())) {
      const std::string damage = damage_of(need);
      if (!damage.empty()) {
        refuse_input("results/" + need + ": " + damage,
                     "remove it with `orchard farm retry`, and run `orchard farm run` again");
      }
    }
  }
}

std::vector<std::string> FarmFolder::result_names() const {
  return io::folder_names(path("results"));
}

std::vector<farm::CostSample> FarmFolder::costs(const std::vector<farm::FarmTask>& tasks) const {
  std::vector<farm::CostSample> samples;
  for (const farm::FarmTask& task : tasks) {
    if (task.kind != farm::TaskKind::kMap) continue;
    std::ifstream file(path("work/cost/" + task.name + ".txt"));
    farm::CostSample sample;
    double wall_s = 0.0;
    if (!(file >> wall_s >> sample.processor_s >> sample.memory_mb)) continue;
    sample.log_mb = static_cast<double>(task.drives.front().num_bytes) / kBytesPerMb;
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace orchard::cli
