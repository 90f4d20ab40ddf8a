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
#include "cli/farm/farm_list.hpp"
#include "io/atomic_file.hpp"
#include "io/companion.hpp"
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

/// The command of a step: that of the list, or the given one.
FarmCommand command_of(const StepCommand& step, bool is_given) {
  FarmCommand command{step.words, {}, {}, {}};
  if (is_given) return command;
  // Maps are made by `orchard`; all else is in this program.
  const std::string orchard = io::program_folder() + "/orchard";
  command.words.insert(command.words.begin(), orchard);
  command.is_own = step.words.front() != "map";
  return command;
}

/// How an attempt at a step ended.
struct Attempt {
  std::string failure;  ///< why there is no result; empty: there is one
  bool is_stopped = false;
};

/// Makes the result.
Attempt make_result(const std::string& name, const StepList& list, const FarmStepOptions& options) {
  list.require_inputs(name);
  const bool is_given = !options.command.empty();
  const StepCommand step = is_given ? StepCommand{options.command, {}} : list.command_of(name);
  UnfinishedResult made(name);
  if (step.words.empty()) {
    made.become_result("set aside: " + step.set_aside);
    return {};
  }
  FarmCommand command = command_of(step, is_given);
  command.stdout_path = "work/output/" + name + ".out";
  command.stderr_path = "work/output/" + name + ".txt";
  for (std::string& word : command.words) {
    if (word == "@out") word = made.folder();
  }
  const CommandResult end = run_command(command);
  if (end.is_stopped) return {"it was stopped", true};
  std::string why = reasons_in(command.stderr_path);
  replace_all(why, made.folder(), "results/" + name);  // the same on every machine
  if (end.exit_code == bus::kExitOk) {
    io::write_file_atomically("work/cost/" + name + ".txt",
                              fixed_text(end.wall_s, 3) + " " + fixed_text(end.processor_s, 3) +
                                  " " + fixed_text(end.memory_mb, 1) + "\n");
    list.require_inputs(name);
    made.become_result("good");
    return {};
  }
  const bool is_crash = is_crash_by_input(end.exit_code);
  if (is_crash) {
    why = "the program crashed (signal " + std::to_string(end.exit_code - 128) +
          "): " + last_line(command.stderr_path);
  } else if (end.exit_code != bus::kExitInput) {
    return {"exit code " + std::to_string(end.exit_code) + ": " + why};
  }
  list.require_inputs(name);
  made.clear();
  made.become_result("set aside: " + why);
  return {};
}

/// Makes a step; what keeps it from having a result is told.
Attempt attempt(const std::string& name, const StepList& list, const FarmStepOptions& options) {
  Attempt made;
  try {
    made = make_result(name, list, options);
  } catch (const std::exception& error) {
    made.failure = error.what();
  }
  if (made.failure.empty()) return made;
  std::ofstream("work/output/" + name + ".txt", std::ios::app)
      << kFailedWord << made.failure << std::endl;
  std::fprintf(stderr, "orchard farm: %s: %s\n", name.c_str(), made.failure.c_str());
  return made;
}

/// Makes what is open of a lot; what failed before comes last, since it may end the whole job.
/// Returns whether all that could begin has a result.
bool make_lot(std::vector<std::string> open, const FarmFolder& farm, const StepList& list,
              const FarmStepOptions& options) {
  std::stable_partition(open.begin(), open.end(), [](const std::string& name) {
    return !fs::exists("work/output/" + name + ".txt");
  });
  const pid_t engine = getppid();
  bool has_all = true;
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (std::string& name : open) {
      if (name.empty() || (options.command.empty() && !list.can_begin(name))) continue;
      const bool is_made = options.command.empty() && farm.is_made(name);
      const Attempt made = is_made ? Attempt() : attempt(name, list, options);
      has_all = has_all && made.failure.empty();
      // Of an engine that was killed the step under way is the last.
      if (made.is_stopped || getppid() != engine) return false;
      name.clear();
      goes_on = true;
    }
  }
  return has_all;
}

}  // namespace

int run_farm_step(const FarmStepOptions& options) {
  static const std::regex kResultName("[a-z]+-[0-9a-f]+");
  if (!std::regex_match(options.name, kResultName))
    throw io::FileError(options.name + ": not a valid name of a result");
  const FarmFolder farm(".");
  for (const char* folder : {"results", "work/cost", "work/output", "work/lots"})
    fs::create_directories(folder);
  const StepList list(farm);
  if (!make_lot(list.steps_of(options.name), farm, list, options)) return bus::kExitRuntime;
  if (options.name.rfind("lot-", 0) == 0) std::ofstream("work/lots/" + options.name);
  return bus::kExitOk;
}

}  // namespace orchard::cli
