// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm_folder.hpp"

#include <sys/stat.h>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
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

const std::string kFileWord = "file ";
constexpr const char* kVersionFile = "work/version.txt";
constexpr const char* kCostsFile = "work/costs.txt";

/// What steps took, by their names: the gathered costs, and those of steps since then.
std::map<std::string, std::string> read_costs(const FarmFolder& farm) {
  std::map<std::string, std::string> costs;
  std::ifstream gathered(farm.path(kCostsFile));
  for (std::string step, cost; gathered >> step && std::getline(gathered >> std::ws, cost);) {
    costs[step] = cost;
  }
  for (const std::string& name : io::folder_names(farm.path("work/cost"))) {
    costs[fs::path(name).stem().string()] = last_line(farm.path("work/cost/" + name));
  }
  return costs;
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
  // A larger one would take longer to clear than most files to read.
  std::array<char, 1 << 16> buffer;
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

std::string identity_of(const std::string& path) {
  struct stat at {};
  if (::stat(path.c_str(), &at) != 0) {
    throw io::SystemError(path + " cannot be read (" + std::strerror(errno) + ")");
  }
  return std::to_string(at.st_size) + " " + std::to_string(at.st_ino) + " " +
         std::to_string(at.st_ctim.tv_sec) + " " + std::to_string(at.st_ctim.tv_nsec);
}

FarmFolder::FarmFolder(std::string root) : root_(std::move(root)) {
  if (!fs::is_regular_file(path("farm.yaml")) || !fs::is_directory(path("logs"))) {
    throw io::FileError(
        root_ +
        " is not a farm (it lacks farm.yaml or logs/); create one with `orchard farm init " +
        root_ + "`");
  }
}

Programs FarmFolder::programs() const {
  const std::string folder = io::program_folder() + "/";
  const std::vector<std::string> files{folder + "orchard", folder + "orchard-maps",
                                       folder + "orchard-gis",  // reads the surveys of rigs
                                       path("Snakefile")};
  std::string identity;
  for (const std::string& file : files) identity += identity_of(file) + "\n";
  if (identity != programs_.identity) programs_ = {identity, digest_of_files(files)};
  return programs_;
}

void FarmFolder::adopt_programs(bool keep_others) const {
  if (keep_others && fs::exists(path(kVersionFile))) return;
  io::write_file_atomically(path(kVersionFile), programs().digest + "\n");
}

FarmContent FarmFolder::read() const {
  FarmContent content = read_content(*this);
  const std::string now = programs().digest;
  std::ifstream adopted(path(kVersionFile));
  if (!std::getline(adopted, content.settings.version)) content.settings.version = now;
  if (content.settings.version != now) {
    content.notes.push_back(
        "the programs or the Snakefile have changed since these results were made; `orchard farm "
        "run` makes all of them anew, --keep-version keeps them and makes only what is missing");
  }
  return content;
}

std::vector<farm::FarmTask> FarmFolder::tasks_of(const FarmContent& content) const {
  std::map<std::string, std::string> known;  // of a date every later one asks
  return farm::tasks_of(content.drives, content.settings, [&](const std::string& name) {
    const auto [edits, is_new] = known.try_emplace(name);
    if (is_new) edits->second = edits_of(name);
    return edits->second;
  });
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

bool FarmFolder::is_made(const std::string& task) const {
  return fs::exists(path("results/" + task + "/state.txt"));
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

std::vector<std::string> FarmFolder::result_names() const {
  return io::folder_names(path("results"));
}

farm::StepCosts FarmFolder::costs(const std::vector<farm::FarmTask>& tasks) const {
  const auto measured = read_costs(*this);
  std::map<farm::TaskKind, std::vector<farm::CostSample>> samples{{farm::TaskKind::kMap, {}}};
  for (const farm::FarmTask& task : tasks) {
    const auto found = measured.find(task.name);
    if (found == measured.end()) continue;
    farm::CostSample sample;
    double wall_s = 0.0;
    std::istringstream line(found->second);
    if (!(line >> wall_s >> sample.processor_s >> sample.memory_mb)) continue;
    sample.log_mb = farm::log_mb(task);
    samples[task.kind].push_back(sample);
  }
  farm::StepCosts costs;
  for (const auto& [kind, of_kind] : samples) costs[kind] = farm::fit_costs(of_kind);
  return costs;
}

void FarmFolder::gather_costs() const {
  const auto measured = read_costs(*this);
  std::string text;
  for (const auto& [step, cost] : measured) text += step + " " + cost + "\n";
  io::write_file_atomically(path(kCostsFile), text);
  for (const auto& [step, cost] : measured) {
    std::error_code ignored;
    fs::remove(path("work/cost/" + step + ".txt"), ignored);
  }
}

}  // namespace orchard::cli
