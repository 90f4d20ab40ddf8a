// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/farm/farm.hpp"
#include "cli/farm/farm_command.hpp"
#include "cli/farm/farm_folder.hpp"
#include "io/companion.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/progress_bar.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;

std::string host_name() {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  return host;
}

/// Whether a temporary folder, ".making-NAME-HOST-PID", is of a step that runs.
bool is_under_way(const std::string& name, bool of_others) {
  const std::string before_pid = "-" + host_name() + "-";
  const std::size_t at = name.rfind(before_pid);
  if (at == std::string::npos) return !of_others;
  const long pid = std::strtol(name.c_str() + at + before_pid.size(), nullptr, 10);
  return pid > 0 && (kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM);
}

int num_open(const FarmFolder& farm, const std::vector<farm::FarmTask>& tasks) {
  int num = 0;
  for (const auto& task : tasks) num += farm.state_of(task.name) ? 0 : 1;
  return num;
}

long memory_mb() { return sysconf(_SC_PHYS_PAGES) / 1024 * (sysconf(_SC_PAGESIZE) / 1024); }

/// Prints the steps that a run would make; writes nothing.
int print_open(const FarmFolder& farm, bool keep_version) {
  FarmContent content = farm.read();
  if (!keep_version) content.settings.version = farm.programs();
  int num = 0;
  for (const farm::FarmTask& task : farm.tasks_of(content)) {
    if (farm.state_of(task.name)) continue;
    std::printf("%-8s %s\n", farm::kind_text(task.kind), task.title().c_str());
    ++num;
  }
  std::printf("%d steps to make\n", num);
  return bus::kExitOk;
}

}  // namespace

RunLock::RunLock(const FarmFolder& farm)
    : fd_(::open(farm.path("work/run.lock").c_str(), O_RDWR | O_CREAT, 0666)) {
  if (fd_ < 0) {
    throw io::FileError(farm.path("work/run.lock") + " cannot be written (" +
                        std::generic_category().message(errno) + ")");
  }
  if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(fd_);
  throw io::FileError(farm.root() +
                      " is already being processed by another `orchard farm run`; see its "
                      "progress with `orchard farm status " +
                      farm.root() + "`");
}

RunLock::~RunLock() { ::close(fd_); }

void remove_unfinished(const FarmFolder& farm, bool of_others) {
  for (const std::string& name : farm.result_names()) {
    if (name.rfind(".making-", 0) != 0 || is_under_way(name, of_others)) continue;
    std::error_code ignored;
    fs::remove_all(farm.path("results/" + name), ignored);
  }
}

int run_farm_run(const FarmRunOptions& options) {
  const FarmFolder farm(options.folder);
  if (options.dry_run) return print_open(farm, options.keep_version);
  const std::string profile = "profiles/" + options.profile;
  if (!fs::is_regular_file(farm.path(profile + "/config.yaml"))) {
    throw io::FileError(farm.path(profile) + " has no config.yaml; choose a profile in " +
                        farm.path("profiles"));
  }
  io::make_folder(farm.path("work"));
  const RunLock lock(farm);
  farm.adopt_programs(options.keep_version);
  const FarmContent content = farm.read();
  const auto tasks = farm.tasks_of(content);
  farm.write_tasks(content, tasks, farm::fit_costs(farm.costs(tasks)));
  remove_unfinished(farm, false);
  int exit_code = 0;
  const int num_to_make = num_open(farm, tasks);
  if (num_to_make > 0) {
    std::vector<std::string> command{
        "snakemake", "--snakefile", "Snakefile", "--profile",
        profile,     "--nolock",    "--config",  "orchard=" + io::program_folder() + "/orchard"};
    if (options.profile == "local") {
      const unsigned cores = options.cores > 0 ? static_cast<unsigned>(options.cores)
                                               : std::max(1U, std::thread::hardware_concurrency());
      command.insert(command.end(), {"--cores", std::to_string(cores), "--resources",
                                     "mem_mb=" + std::to_string(memory_mb() * 9 / 10)});
    } else if (options.cores > 0) {
      command.insert(command.end(), {"--jobs", std::to_string(options.cores)});
    }
    io::ProgressBar bar("farm");
    const std::string said = fs::absolute(farm.path("work/snakemake.txt")).string();
    exit_code =
        run_command({command, said, said, farm.root(),
                     [&] {
                       bar.update(static_cast<std::uint64_t>(num_to_make - num_open(farm, tasks)),
                                  static_cast<std::uint64_t>(num_to_make));
                     }})
            .exit_code;
    bar.finish();
    if (exit_code == 127) {
      throw io::SystemError(
          "snakemake, which runs the steps of a farm, is not installed: apt-get install "
          "--no-install-recommends snakemake");
    }
  }
  const int num_left = num_open(farm, tasks);
  std::printf("%d steps made\n%s", num_to_make - num_left,
              status_text(farm, content, tasks, false).c_str());
  print_notes("run", content);
  if (num_left == 0) return bus::kExitOk;
  std::fprintf(stderr,
               "orchard farm run: %d steps have no result (exit code %d of snakemake); see the "
               "errors in %s and run it again to do the remaining steps\n",
               num_left, exit_code, farm.path("work/snakemake.txt").c_str());
  return bus::kExitRuntime;
}

}  // namespace orchard::cli
