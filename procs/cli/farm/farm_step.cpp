// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm_step.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "bus/process/process.hpp"
#include "cli/farm/command_run.hpp"
#include "cli/farm/farm_folder.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;

/// Min free disk space for setting a result aside: with less, a failed write may look like a bad
/// input.
constexpr std::uintmax_t kFreeBytesMin = 16 << 20;

std::string unlike_any_other() {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  return std::string(host) + "-" + std::to_string(getpid());
}

std::string last_line(const std::string& path) {
  std::ifstream file(path);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

bool is_crash(int exit_code) {
  constexpr std::array<int, 5> kCrashes{SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL};
  return std::count(kCrashes.begin(), kCrashes.end(), exit_code - 128) > 0;
}

/// Renames the finished folder to the result, unless another process has completed the same result.
void become_result(const std::string& made, const std::string& name, const std::string& state) {
  const std::string result = "results/" + name;
  const std::string corrections = corrections_line(made);
  io::write_file_atomically(made + "/state.txt",
                            state + "\n" + (corrections.empty() ? "" : corrections + "\n"));
  if (fs::exists(result + "/state.txt")) {
    fs::remove_all(made);
    return;
  }
  fs::remove_all(result);  // empty, or an incomplete result without state.txt
  io::rename_durably(made, result);
}

}  // namespace

int run_farm_step(const FarmStepOptions& options) {
  if (!is_farm_name(options.name))
    throw io::FileError(options.name + ": not a valid name of a result");
  for (const char* folder : {"results", "work/cost", "work/output"}) fs::create_directories(folder);
  const std::string made = "results/.making-" + options.name + "-" + unlike_any_other();
  fs::remove_all(made);
  fs::create_directory(made);
  if (options.command.empty()) {
    become_result(made, options.name, "set aside: " + options.set_aside);
    return bus::kExitOk;
  }

  std::vector<std::string> command = options.command;
  for (std::string& word : command) {
    if (word == "@out") word = made;
  }
  const std::string output = "work/output/" + options.name + ".txt";
  const CommandResult end =
      run_command(command, output, options.keep_output ? made + "/said.txt" : std::string());
  std::error_code error;
  const bool is_disk_well =
      fs::exists(made) && fs::space("results", error).available > kFreeBytesMin && !error;
  if (end.exit_code == bus::kExitOk || (options.keep_output && end.exit_code == bus::kExitInput)) {
    io::write_file_atomically("work/cost/" + options.name + ".txt",
                              fixed_text(end.wall_s, 3) + " " + fixed_text(end.processor_s, 3) +
                                  " " + fixed_text(end.memory_mb, 1) + "\n");
    become_result(made, options.name, "good");
    return bus::kExitOk;
  }
  std::string why = last_line(output);
  for (std::size_t at = why.find(made); at != std::string::npos; at = why.find(made)) {
    why.replace(at, made.size(), "results/" + options.name);  // independent of the temporary name
  }
  if (is_crash(end.exit_code)) {
    why = "the program crashed (signal " + std::to_string(end.exit_code - 128) + "): " + why;
  }
  if (is_disk_well && (end.exit_code == bus::kExitInput || is_crash(end.exit_code))) {
    fs::remove_all(made);
    fs::create_directory(made);
    become_result(made, options.name, "set aside: " + why);
    return bus::kExitOk;
  }
  fs::remove_all(made, error);
  std::fprintf(stderr, "orchard farm: %s: exit code %d: %s\n", options.name.c_str(), end.exit_code,
               why.c_str());
  return bus::kExitRuntime;
}

}  // namespace orchard::cli
