// SPDX-License-Identifier: BSD-3-Clause
#include "cli/farm/farm.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/farm/farm_folder.hpp"
#include "io/atomic_file.hpp"
#include "io/companion.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/map/corrections_file.hpp"
#include "io/progress_bar.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

/// Exit code and resource usage of a command.
struct CommandResult {
  int exit_code = 0;  ///< 128 + signal if it was killed; 127 if it cannot be run
  double wall_s = 0.0;
  double processor_s = 0.0;
  double memory_mb = 0.0;  ///< peak of its largest process
};

constexpr int kLookEvery_ms = 500;

int open_for_writing(const std::string& path) {
  if (path.empty()) return -1;
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) throw std::system_error(errno, std::generic_category(), path);
  return fd;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Ignores SIGINT in this process: Ctrl-C reaches the whole process group, so the command ends by
/// itself, and this process after it.
class IgnoredInterrupt {
 public:
  IgnoredInterrupt() {
    struct sigaction ignore {};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGINT, &ignore, &before_);
  }
  ~IgnoredInterrupt() { sigaction(SIGINT, &before_, nullptr); }
  IgnoredInterrupt(const IgnoredInterrupt&) = delete;
  IgnoredInterrupt& operator=(const IgnoredInterrupt&) = delete;
  const struct sigaction& before() const { return before_; }

 private:
  struct sigaction before_ {};
};

/// Runs a program of the search path and waits for its end. Its output is written to `output_path`
/// (empty: to this process's output), standard output to `stdout_path` if given. `in_folder`:
/// working folder; empty: the current one. `while_running`, if given, is called twice a second.
/// Throws std::system_error when no process can be created.
CommandResult run_command(const std::vector<std::string>& arguments, const std::string& output_path,
                          const std::string& stdout_path = {}, const std::string& in_folder = {},
                          const std::function<void()>& while_running = {}) {
  std::vector<std::string> words = arguments;
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int output = open_for_writing(output_path);
  const int standard = stdout_path.empty() ? -1 : open_for_writing(stdout_path);
  const IgnoredInterrupt ignored;
  const auto start = std::chrono::steady_clock::now();
  const pid_t pid = fork();
  if (pid == 0) {  // only calls that are safe between fork and exec
    sigaction(SIGINT, &ignored.before(), nullptr);
    if (output >= 0) dup2(output, STDOUT_FILENO), dup2(output, STDERR_FILENO);
    if (standard >= 0) dup2(standard, STDOUT_FILENO);
    if (!in_folder.empty() && chdir(in_folder.c_str()) != 0) _exit(127);
    execvp(argv.front(), argv.data());
    _exit(127);
  }
  const int error = errno;
  if (output >= 0) close(output);
  if (standard >= 0) close(standard);
  if (pid < 0) throw std::system_error(error, std::generic_category(), "starting " + words.front());
  if (while_running) {
    pollfd ended{static_cast<int>(syscall(SYS_pidfd_open, pid, 0)), POLLIN, 0};
    while (ended.fd >= 0 && poll(&ended, 1, kLookEvery_ms) <= 0) while_running();
    if (ended.fd >= 0) close(ended.fd);
  }
  int status = 0;
  rusage usage{};
  while (wait4(pid, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  CommandResult end;
  end.exit_code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  end.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  end.processor_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  end.memory_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return end;
}

namespace fs = std::filesystem;

/// Min free disk space for setting a result aside: with less, a failed write may look like a bad
/// input.
constexpr std::uintmax_t kFreeBytesMin = 16 << 20;

std::string unlike_any_other() {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  return std::string(host) + "-" + std::to_string(getpid());
}

/// The last line of a file that is not empty; empty: none.
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
  static const std::regex kResultName("[a-z]+-[0-9a-f]+");
  if (!std::regex_match(options.name, kResultName))
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

namespace {

using farm::FarmTask;
using farm::TaskKind;

constexpr std::array<TaskKind, 6> kKinds{TaskKind::kCheck,   TaskKind::kMap,    TaskKind::kDate,
                                         TaskKind::kChanges, TaskKind::kReport, TaskKind::kPublish};

/// An event to report, and the drive or date that it concerns.
struct Finding {
  std::string what;  ///< "set aside", "left out", "damaged", "pieces", "not published"
  std::string of;
  std::string reason;
};

struct Counts {
  int num_good = 0, num_aside = 0, num_open = 0;
};

struct FarmState {
  std::array<Counts, kKinds.size()> counts;
  std::vector<Finding> findings;
  double open_s = 0.0;  ///< expected processor time of the open maps
};

std::string title_of(const FarmTask& task) {
  const farm::Drive& drive = task.drives.front();
  return task.kind == TaskKind::kCheck || task.kind == TaskKind::kMap
             ? drive.title()
             : drive.block + "/" + drive.date;
}

/// Adds the maps that `merge --leave-out` left out of a date, with reasons (left_out.csv).
void add_left_out(const FarmFolder& farm, const FarmTask& task, const std::vector<FarmTask>& tasks,
                  std::vector<Finding>& findings) {
  std::ifstream file(farm.path("results/" + task.name + "/left_out.csv"));
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    for (const FarmTask& map : tasks) {
      const std::string begin = "\"results/" + map.name + "\",\"";
      if (line.rfind(begin, 0) != 0) continue;
      for (const farm::Drive& drive : map.drives) {
        if (drive.block != task.drives.front().block || drive.date != task.drives.front().date) {
          continue;
        }
        findings.push_back(
            {"left out", drive.title(), line.substr(begin.size(), line.size() - begin.size() - 1)});
      }
    }
  }
}

/// Adds what `orchard log check` said of a log: damage, and seconds between its pieces that none of
/// them covers.
void add_checked(const FarmFolder& farm, const FarmTask& task, std::vector<Finding>& findings) {
  std::ifstream file(farm.path("results/" + task.name + "/said.txt"));
  const auto said = nlohmann::json::parse(file, nullptr, false);
  const auto list = [&said](const char* key) {
    return said.is_object() && said.contains(key) ? said[key] : nlohmann::json::array();
  };
  std::set<std::string> damaged;
  for (const auto& gap : list("gaps")) {
    damaged.insert(fs::path(gap.value("log", std::string())).filename().string());
  }
  std::string where;
  for (const std::string& name : damaged) where += (where.empty() ? "" : ", ") + name;
  if (!where.empty()) where += ": ";
  for (const farm::Drive& drive : task.drives) {
    if (!said.is_object() || !said.value("sound", false)) {
      findings.push_back({"damaged", drive.title(),
                          where + "the readable part was mapped; see `orchard log check`"});
    }
    for (const auto& note : list("notes")) {
      findings.push_back({"pieces", drive.title(), note.get<std::string>()});
    }
  }
}

FarmState state_of(const FarmFolder& farm, const std::vector<FarmTask>& tasks,
                   const farm::CostFit& costs) {
  FarmState state;
  std::set<std::string> mapped;  // digests of logs
  for (const FarmTask& task : tasks) {
    const auto made = farm.state_of(task.name);
    if (task.kind == TaskKind::kMap && made && made->is_good) {
      mapped.insert(task.drives.front().log_digest);
    }
  }
  for (const FarmTask& task : tasks) {
    Counts& counts = state.counts[static_cast<std::size_t>(task.kind)];
    const auto made = farm.state_of(task.name);
    ++(!made ? counts.num_open : made->is_good ? counts.num_good : counts.num_aside);
    if (!made) {
      if (task.kind == TaskKind::kMap) {
        state.open_s += costs.ask_s.at_least +
                        costs.ask_s.per_mb * 1e-6 * static_cast<double>(task.drives[0].num_bytes);
      }
      if (task.kind == TaskKind::kPublish) {
        const std::string why = last_line(farm.path("work/output/" + task.name + ".txt"));
        if (!why.empty()) state.findings.push_back({"not published", title_of(task), why});
      }
      continue;
    }
    if (!made->is_good) {
      for (const farm::Drive& drive : task.drives) {
        const bool is_of_drive = task.kind == TaskKind::kMap || task.kind == TaskKind::kCheck;
        state.findings.push_back({std::string("set aside (") + farm::kind_text(task.kind) + ")",
                                  is_of_drive ? drive.title() : title_of(task), made->reason});
        if (!is_of_drive) break;
      }
    } else if (task.kind == TaskKind::kDate) {
      add_left_out(farm, task, tasks, state.findings);
    } else if (task.kind == TaskKind::kCheck && mapped.count(task.drives.front().log_digest) > 0) {
      add_checked(farm, task, state.findings);
    }
  }
  return state;
}

void print_notes(const char* command, const FarmContent& content) {
  for (const std::string& note : content.notes) {
    std::fprintf(stderr, "orchard farm %s: note: %s\n", command, note.c_str());
  }
}

std::string cost_text(const char* what, const char* unit, const farm::CostLine& line) {
  return fmt::format("{}: {:.2f} {} + {:.2f} {} per km + {:.4f} {} per tree", what, line.at_least,
                     unit, line.per_km, unit, line.per_tree, unit);
}

}  // namespace

std::string status_text(const FarmFolder& farm, const FarmContent& content,
                        const std::vector<FarmTask>& tasks, bool json) {
  const auto samples = farm.costs(tasks);
  const farm::CostFit costs = farm::fit_costs(samples);
  const FarmState state = state_of(farm, tasks, costs);
  std::set<std::string> blocks, dates;
  for (const farm::Drive& drive : content.drives) {
    blocks.insert(drive.block);
    dates.insert(drive.block + "/" + drive.date);
  }
  if (json) {
    using nlohmann::ordered_json;
    ordered_json all{{"num_blocks", blocks.size()},
                     {"num_dates", dates.size()},
                     {"num_drives", content.drives.size()}};
    for (const TaskKind kind : kKinds) {
      const Counts& c = state.counts[static_cast<std::size_t>(kind)];
      all["steps"][farm::kind_text(kind)] = {
          {"good", c.num_good}, {"set_aside", c.num_aside}, {"open", c.num_open}};
    }
    all["notes"] = content.notes;
    all["findings"] = ordered_json::array();
    for (const Finding& f : state.findings) {
      all["findings"].push_back({{"what", f.what}, {"of", f.of}, {"reason", f.reason}});
    }
    const auto line = [](const farm::CostLine& l) {
      return ordered_json{{"at_least", l.at_least}, {"per_km", l.per_km}, {"per_tree", l.per_tree}};
    };
    all["map_cost"] = {{"num_maps", samples.size()},
                       {"time_s", line(costs.time_s)},
                       {"memory_mb", line(costs.memory_mb)}};
    all["open_s"] = state.open_s;
    // A note or a reason may name a file whose name is no UTF-8.
    return all.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  }
  std::string text = fmt::format("{} blocks, {} dates, {} drives\n", blocks.size(), dates.size(),
                                 content.drives.size());
  for (const TaskKind kind : kKinds) {
    const Counts& c = state.counts[static_cast<std::size_t>(kind)];
    if (kind == TaskKind::kPublish && content.settings.publish_to.empty()) continue;
    text += fmt::format("{:<8} {:6} made, {:4} set aside, {:6} to make\n", farm::kind_text(kind),
                        c.num_good, c.num_aside, c.num_open);
  }
  for (const Finding& f : state.findings) {
    text += fmt::format("{}: {}: {}\n", f.what, f.of, f.reason);
  }
  if (!samples.empty()) {
    text += fmt::format("cost of a map, fitted to {} maps: {}; {}\n", samples.size(),
                        cost_text("core time", "s", costs.time_s),
                        cost_text("memory", "MB", costs.memory_mb));
  }
  if (state.open_s > 0.0) {
    text += fmt::format("the remaining maps will take about {:.0f} s of one core\n", state.open_s);
  }
  return text;
}

int run_farm_status(const FarmStatusOptions& options) {
  const FarmFolder farm(options.folder);
  const FarmContent content = farm.read();
  const auto tasks = farm.tasks_of(content);
  farm.write_tasks(content, tasks, farm::fit_costs(farm.costs(tasks)));
  std::fputs(status_text(farm, content, tasks, options.json).c_str(), stdout);
  print_notes("status", content);
  return bus::kExitOk;
}

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
  io::make_folder(farm.path("work"));
  const RunLock lock(farm);
  farm.adopt_programs(options.keep_version);
  const FarmContent content = farm.read();
  const auto tasks = farm.tasks_of(content);
  farm.write_tasks(content, tasks, farm::fit_costs(farm.costs(tasks)));
  remove_unfinished(farm);
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
    exit_code = run_command(command, farm.path("work/snakemake.txt"), {}, farm.root(), [&] {
                  bar.update(static_cast<std::uint64_t>(num_to_make - num_open(farm, tasks)),
                             static_cast<std::uint64_t>(num_to_make));
                }).exit_code;
    bar.finish();
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
  print_notes("publish", content);
  if (num_open > 0) {
    std::fprintf(
        stderr, "orchard farm publish: note: %d results do not exist yet; run `orchard farm run`\n",
        num_open);
  }
  return num_kept == 0 ? bus::kExitOk : bus::kExitRuntime;
}

}  // namespace orchard::cli
