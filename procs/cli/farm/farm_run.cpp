// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm_run.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <set>
#include <system_error>
#include <thread>

#include "bus/process/process.hpp"
#include "cli/farm/command_run.hpp"
#include "cli/farm/farm_status.hpp"
#include "cli/program_folder.hpp"
#include "io/file_error.hpp"
#include "io/map/corrections_file.hpp"
#include "io/progress_bar.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;

/// Allows one run at a time. Snakemake inherits the lock, so it is held until that has ended, too.
class RunLock {
 public:
  explicit RunLock(const FarmFolder& farm)
      : fd_(::open(farm.path("work/run.lock").c_str(), O_RDWR | O_CREAT, 0666)) {
    if (fd_ < 0) {
      throw io::FileError(farm.path("work/run.lock") + " cannot be written (" +
                          std::generic_category().message(errno) + ")");
    }
    // A run that was just killed may take a moment to end.
    for (int tries = 0; ::flock(fd_, LOCK_EX | LOCK_NB) != 0; ++tries) {
      if (tries < 50) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        continue;
      }
      ::close(fd_);
      throw io::FileError(farm.root() +
                          " is already being processed by another `orchard farm run`; see its "
                          "progress with `orchard farm status " +
                          farm.root() + "`");
    }
  }
  ~RunLock() { ::close(fd_); }
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

 private:
  int fd_;
};

/// Removes the temporary folders of steps that were killed on this machine.
void remove_unfinished(const FarmFolder& farm) {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(farm.path("results"), error)) {
    const std::string name = entry.path().filename().string();
    const std::string before_pid = std::string("-") + host + "-";
    const std::size_t at = name.rfind(before_pid);
    if (name.rfind(".making-", 0) != 0 || at == std::string::npos) continue;
    const long pid = std::strtol(name.c_str() + at + before_pid.size(), nullptr, 10);
    if (pid > 0 && (kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM)) continue;
    fs::remove_all(entry.path(), error);
  }
}

bool is_on_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::string folders = path ? path : "";
  while (!folders.empty()) {
    const std::size_t colon = folders.find(':');
    if (::access((folders.substr(0, colon) + "/" + program).c_str(), X_OK) == 0) return true;
    folders = colon == std::string::npos ? "" : folders.substr(colon + 1);
  }
  return false;
}

int num_open(const FarmFolder& farm, const std::vector<farm::FarmTask>& tasks) {
  int num = 0;
  for (const auto& task : tasks) num += farm.state_of(task.name) ? 0 : 1;
  return num;
}

long memory_mb() { return sysconf(_SC_PHYS_PAGES) / 1024 * (sysconf(_SC_PAGESIZE) / 1024); }

/// Atomically points a symbolic link to another folder.
void point_to(const std::string& link, const std::string& target) {
  fs::create_directories(fs::path(link).parent_path());
  const std::string made = link + ".new";
  std::error_code error;
  fs::remove(made, error);
  fs::create_directory_symlink(target, made);
  fs::rename(made, link);
}

}  // namespace

int run_farm_run(const FarmRunOptions& options) {
  const FarmFolder farm(options.folder);
  if (!is_on_path("snakemake")) {
    throw io::FileError(
        "snakemake, which runs the steps of a farm, is not installed: apt-get install "
        "--no-install-recommends snakemake");
  }
  const std::string profile = "profiles/" + options.profile;
  if (!fs::is_regular_file(farm.path(profile + "/config.yaml"))) {
    throw io::FileError(farm.path(profile) + " has no config.yaml; choose a profile in " +
                        farm.path("profiles"));
  }
  const FarmContent content = farm.read();
  const RunLock lock(farm);
  const auto tasks = farm.tasks_of(content);
  farm.write_tasks(content, tasks, farm::fit_costs(farm.costs(tasks)));
  remove_unfinished(farm);
  int exit_code = 0;
  const int num_to_make = num_open(farm, tasks);
  if (num_to_make > 0) {
    std::vector<std::string> command{
        "snakemake", "--snakefile", "Snakefile", "--profile",
        profile,     "--nolock",    "--config",  "orchard=" + program_folder() + "/orchard"};
    if (options.profile == "local") {
      const unsigned cores = options.cores > 0 ? static_cast<unsigned>(options.cores)
                                               : std::max(1U, std::thread::hardware_concurrency());
      command.insert(command.end(), {"--cores", std::to_string(cores), "--resources",
                                     "mem_mb=" + std::to_string(memory_mb() * 9 / 10)});
    } else if (options.cores > 0) {
      command.insert(command.end(), {"--jobs", std::to_string(options.cores)});
    }
    io::ProgressBar bar("farm");
    exit_code = run_command(command, farm.path("work/snakemake.txt"), {}, farm.root(), [&] {
                  bar.update(static_cast<std::uint64_t>(num_to_make - num_open(farm, tasks)),
                             static_cast<std::uint64_t>(num_to_make));
                }).exit_code;
    bar.finish();
  }
  const int num_left = num_open(farm, tasks);
  std::printf("%d steps made\n%s", num_to_make - num_left,
              status_text(farm, content, tasks, false).c_str());
  for (const std::string& note : content.notes) {
    std::fprintf(stderr, "orchard farm run: note: %s\n", note.c_str());
  }
  if (num_left == 0) return bus::kExitOk;
  std::fprintf(stderr,
               "orchard farm run: %d steps have no result (exit code %d of snakemake); see the "
               "errors in %s and run it again to do the remaining steps\n",
               num_left, exit_code, farm.path("work/snakemake.txt").c_str());
  return bus::kExitRuntime;
}

int run_farm_publish(const FarmPublishOptions& options) {
  const FarmFolder farm(options.folder);
  const FarmContent content = farm.read();
  int num_maps = 0, num_changes = 0, num_reports = 0, num_open = 0, num_kept = 0;
  for (const farm::FarmTask& task : farm.tasks_of(content)) {
    const bool is_date = task.kind == farm::TaskKind::kDate;
    const bool is_report = task.kind == farm::TaskKind::kReport;
    if (!is_date && !is_report && task.kind != farm::TaskKind::kChanges) continue;
    const auto state = farm.state_of(task.name);
    num_open += state ? 0 : 1;
    if (!state || !state->is_good) continue;
    ++(is_date ? num_maps : is_report ? num_reports : num_changes);
    std::set<std::string> places;  // equal dates of several blocks share one result
    for (const farm::Drive& drive : task.drives) places.insert(drive.block + "/" + drive.date);
    for (const std::string& place : places) {
      const std::string link = farm.path((is_date     ? "maps/"
                                          : is_report ? "reports/"
                                                      : "changes/") +
                                         place);
      std::error_code error;
      const std::string before = fs::read_symlink(link, error).filename().string();
      if (is_date && before != task.name && !farm.edits_of(before).empty()) {
        std::fprintf(stderr,
                     "orchard farm publish: warning: %s was corrected by hand and is not replaced; "
                     "the newer map is %s: correct it, too (`orchard edit`), then remove %s/%s\n",
                     link.c_str(), farm.path("results/" + task.name).c_str(),
                     farm.path("results/" + before).c_str(), io::kCorrectionsFile);
        ++num_kept;
        continue;
      }
      point_to(link, "../../results/" + task.name);
    }
  }
  std::printf("%d maps in %s, %d comparisons in %s, %d reports in %s\n", num_maps,
              farm.path("maps").c_str(), num_changes, farm.path("changes").c_str(), num_reports,
              farm.path("reports").c_str());
  if (num_open > 0) {
    std::fprintf(
        stderr, "orchard farm publish: note: %d results do not exist yet; run `orchard farm run`\n",
        num_open);
  }
  return num_kept == 0 ? bus::kExitOk : bus::kExitRuntime;
}

}  // namespace orchard::cli
