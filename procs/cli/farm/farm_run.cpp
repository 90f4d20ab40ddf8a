// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/farm/farm.hpp"
#include "cli/farm/farm_command.hpp"
#include "cli/farm/farm_folder.hpp"
#include "cli/farm/farm_list.hpp"
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

std::set<std::string> open_steps(const FarmFolder& farm, const std::vector<farm::FarmTask>& tasks) {
  std::set<std::string> open;
  for (const auto& task : tasks) {
    if (!farm.is_made(task.name)) open.insert(task.name);
  }
  return open;
}

/// How many of some steps have a result by now.
class Progress {
 public:
  Progress(const FarmFolder& farm, const std::set<std::string>& open)
      : farm_(farm), open_(open), bar_("farm") {}

  /// Reads the folder of results at most a hundredth of the time, however large it is.
  void update() {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    if (begin < next_) return;
    std::uint64_t num = 0;
    for (const std::string& name : farm_.result_names()) num += open_.count(name);
    bar_.update(num, open_.size());
    next_ = Clock::now() + 100 * (Clock::now() - begin);
  }
  void finish() { bar_.finish(); }

 private:
  const FarmFolder& farm_;
  const std::set<std::string>& open_;
  io::ProgressBar bar_;
  std::chrono::steady_clock::time_point next_{};
};

long memory_mb() { return sysconf(_SC_PHYS_PAGES) / 1024 * (sysconf(_SC_PAGESIZE) / 1024); }

/// Prints the steps that a run would make; writes nothing.
int print_open(const FarmFolder& farm, bool keep_version) {
  FarmContent content = farm.read();
  if (!keep_version) content.settings.version = farm.programs().digest;
  int num = 0;
  for (const farm::FarmTask& task : farm.tasks_of(content)) {
    if (farm.is_made(task.name)) continue;
    std::printf("%-8s %s\n", farm::kind_text(task.kind), task.title().c_str());
    ++num;
  }
  std::printf("%d steps to make\n", num);
  return bus::kExitOk;
}

/// How many jobs run at a time; 0: as many as the profile says.
int num_jobs_of(const FarmRunOptions& options) {
  if (options.cores > 0 || options.profile != "local") return options.cores;
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

/// Snakemake's words but for the phase.
std::vector<std::string> engine_words(const FarmRunOptions& options) {
  std::vector<std::string> words{
      "snakemake", "--snakefile", "Snakefile", "--profile", "profiles/" + options.profile,
      "--nolock"};
  if (options.profile == "local") {
    words.insert(words.end(), {"--cores", std::to_string(num_jobs_of(options)), "--resources",
                               "mem_mb=" + std::to_string(memory_mb() * 9 / 10)});
  } else if (options.cores > 0) {
    words.insert(words.end(), {"--jobs", std::to_string(options.cores)});
  }
  return words;
}

/// Has Snakemake make the lots, first those of maps, then, whatever became of these, all others.
/// Returns its worst exit code.
int run_engine(const FarmFolder& farm, const FarmRunOptions& options, const farm::Lots& lots,
               Progress& progress) {
  const std::string said = fs::absolute(farm.path("work/snakemake.txt")).string();
  std::error_code ignored;
  fs::remove(said, ignored);
  fs::remove_all(farm.path("work/lots"), ignored);  // of another run
  int exit_code = 0;
  for (const auto& [phase, of_phase] : {std::pair{"maps", &lots.maps}, {"others", &lots.others}}) {
    if (of_phase->empty()) continue;
    std::vector<std::string> words = engine_words(options);
    words.insert(words.end(), {"--config", "orchard=" + io::program_folder() + "/orchard-maps",
                               std::string("phase=") + phase});
    const CommandResult end =
        run_command({words, false, said, said, farm.root(), [&] { progress.update(); }});
    if (end.exit_code == 127) {
      throw io::SystemError(
          "snakemake, which runs the steps of a farm, is not installed: apt-get install "
          "--no-install-recommends snakemake");
    }
    exit_code = std::max(exit_code, end.exit_code);
    if (end.is_stopped) break;
  }
  progress.finish();
  return exit_code;
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
  const auto costs = farm.costs(tasks);
  const auto to_make = open_steps(farm, tasks);
  const farm::Lots lots = farm::lots_of(
      tasks, costs, [&](const farm::FarmTask& task) { return to_make.count(task.name) > 0; },
      num_jobs_of(options));
  write_list(farm, content, tasks, lots);
  remove_unfinished(farm, false);
  Progress progress(farm, to_make);
  const int exit_code = to_make.empty() ? 0 : run_engine(farm, options, lots, progress);
  farm.gather_costs();
  const std::size_t num_left = open_steps(farm, tasks).size();
  std::printf("%zu steps made\n%s", to_make.size() - num_left,
              status_text(farm, content, tasks, false).c_str());
  print_notes("run", content);
  if (num_left == 0) return bus::kExitOk;
  std::fprintf(stderr,
               "orchard farm run: %zu steps have no result (exit code %d of snakemake); see the "
               "errors in %s and run it again to do the remaining steps\n",
               num_left, exit_code, farm.path("work/snakemake.txt").c_str());
  return bus::kExitRuntime;
}

}  // namespace orchard::cli
