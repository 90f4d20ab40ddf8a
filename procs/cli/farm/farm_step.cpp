// SPDX-License-Identifier: BSD-3-Clause
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "bus/process/process.hpp"
#include "cli/farm/farm.hpp"
#include "cli/farm/farm_command.hpp"
#include "cli/farm/farm_folder.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/map/corrections_file.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;

/// The folder that a step writes into; removed at the end unless it has become the result.
class UnfinishedResult {
 public:
  explicit UnfinishedResult(std::string name)
      : name_(std::move(name)), folder_("results/.making-" + name_ + unlike_any_other()) {
    fs::create_directories(folder_);
  }
  ~UnfinishedResult() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  UnfinishedResult(const UnfinishedResult&) = delete;
  UnfinishedResult& operator=(const UnfinishedResult&) = delete;

  const std::string& folder() const { return folder_; }

  /// Without what the command has written.
  void clear() {
    fs::remove_all(folder_);
    fs::create_directory(folder_);
  }

  /// Renames the folder to the result, unless another process has completed the same one.
  void become_result(const std::string& state) {
    const std::string result = "results/" + name_, corrections = corrections_line(folder_);
    std::string text = state + "\n" + (corrections.empty() ? "" : corrections + "\n");
    for (const std::string& name : files()) {
      text += "file " + digest_of_files({folder_ + "/" + name}) + " " + name + "\n";
    }
    io::write_file_atomically(folder_ + "/state.txt", text);
    if (fs::exists(result + "/state.txt")) return;
    fs::remove_all(result);  // empty, or an incomplete result without state.txt
    io::rename_durably(folder_, result);
  }

 private:
  static std::string unlike_any_other() {
    char host[256] = {};
    gethostname(host, sizeof(host) - 1);
    return std::string("-") + host + "-" + std::to_string(getpid());
  }

  /// All files but the corrections, which people go on to write.
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      const std::string name = entry.path().lexically_relative(folder_).string();
      if (entry.is_regular_file() && name != io::kCorrectionsFile) names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  std::string name_, folder_;
};

/// A crash that depends on the input and would recur, as far as can be told: without a memory limit
/// and without a file that cannot be mapped (SIGBUS).
bool is_crash_by_input(int exit_code) {
  constexpr std::array<int, 4> kCrashes{SIGSEGV, SIGABRT, SIGFPE, SIGILL};
  for (const auto what : {RLIMIT_AS, RLIMIT_DATA}) {
    rlimit limit{};
    if (getrlimit(what, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) return false;
  }
  return std::count(kCrashes.begin(), kCrashes.end(), exit_code - 128) > 0;
}

/// What a command says of its failure: all reasons, without notes and warnings.
std::string reasons_in(const std::string& stderr_path) {
  std::ifstream file(stderr_path);
  std::string all;
  for (std::string line; std::getline(file, line);) {
    const bool is_remark =
        line.find(": note: ") != std::string::npos || line.find(": warning: ") != std::string::npos;
    if (!line.empty() && !is_remark) all += (all.empty() ? "" : "; ") + line;
  }
  return all.empty() ? last_line(stderr_path) : all;
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
    text.replace(at, from.size(), to);
    at += to.size();
  }
}

/// Makes the result. Returns why there is none; empty: there is one.
std::string make_result(const FarmStepOptions& options, const FarmFolder& farm) {
  UnfinishedResult made(options.name);
  if (options.command.empty()) {
    made.become_result("set aside: " + options.set_aside);
    return {};
  }
  FarmCommand command{options.command, "work/output/" + options.name + ".out",
                      "work/output/" + options.name + ".txt"};
  for (std::string& word : command.words) {
    if (word == "@out") word = made.folder();
  }
  const CommandResult end = run_command(command);
  std::string why = reasons_in(command.stderr_path);
  replace_all(why, made.folder(), "results/" + options.name);  // the same on every machine
  if (end.exit_code == bus::kExitOk) {
    io::write_file_atomically("work/cost/" + options.name + ".txt",
                              fixed_text(end.wall_s, 3) + " " + fixed_text(end.processor_s, 3) +
                                  " " + fixed_text(end.memory_mb, 1) + "\n");
    farm.require_inputs(options.name);
    made.become_result("good");
    return {};
  }
  const bool is_crash = is_crash_by_input(end.exit_code);
  if (is_crash) {
    why = "the program crashed (signal " + std::to_string(end.exit_code - 128) +
          "): " + last_line(command.stderr_path);
  } else if (end.exit_code != bus::kExitInput) {
    return "exit code " + std::to_string(end.exit_code) + ": " + why;
  }
  farm.require_inputs(options.name);
  made.clear();
  made.become_result("set aside: " + why);
  return {};
}

}  // namespace

int run_farm_step(const FarmStepOptions& options) {
  static const std::regex kResultName("[a-z]+-[0-9a-f]+");
  if (!std::regex_match(options.name, kResultName))
    throw io::FileError(options.name + ": not a valid name of a result");
  const FarmFolder farm(".");
  for (const char* folder : {"results", "work/cost", "work/output"}) fs::create_directories(folder);
  std::string why;
  try {
    farm.require_inputs(options.name);
    why = make_result(options, farm);
  } catch (const std::exception& error) {
    why = error.what();
  }
  if (why.empty()) return bus::kExitOk;
  std::ofstream("work/output/" + options.name + ".txt", std::ios::app)
      << kFailedWord << why << std::endl;
  std::fprintf(stderr, "orchard farm: %s: %s\n", options.name.c_str(), why.c_str());
  return bus::kExitRuntime;
}

}  // namespace orchard::cli
