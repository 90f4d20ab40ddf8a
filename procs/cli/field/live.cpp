// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/field.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "bus/bus.hpp"
#include "bus/messages/channel.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/process/process.hpp"
#include "cli/field/status_board.hpp"
#include "io/companion.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/log/log_reader.hpp"
#include "text/nearest_word.hpp"

namespace orchard::cli {
namespace {

/// A process to be started, and its place in the order of stopping.
struct ChildPlan {
  std::string name;                    ///< process name, "orchard-detector"
  std::vector<std::string> arguments;  ///< the program's path first
  std::string log_path;                ///< its standard output and error are appended here
  /// Stages are stopped in ascending order, each after the one before has ended: senders before
  /// receivers.
  int stage = 0;
  /// True for a player of a log: it starts once all other processes have sent STATUS, so that they
  /// receive all its messages.
  bool plays = false;
};

constexpr std::chrono::seconds kLongLife{10};
constexpr std::chrono::milliseconds kFirstWait{200};
constexpr std::chrono::milliseconds kWaitMax{5000};

/// Runs in the child between fork and exec; calls only async-signal-safe functions.
[[noreturn]] void become(const std::vector<char*>& arguments, int log) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);  // Ctrl-C reaches only the parent, which stops the children in order
  prctl(PR_SET_PDEATHSIG, SIGTERM);  // if the parent is killed, the child stops
  if (log >= 0) {
    dup2(log, STDOUT_FILENO);
    dup2(log, STDERR_FILENO);
  }
  execv(arguments.front(), arguments.data());
  _exit(127);
}

/// A child process that is monitored, restarted when it fails, and stopped.
class ChildProcess {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ChildProcess(ChildPlan plan) : plan_(std::move(plan)) {}
  ~ChildProcess() {
    if (pid_ > 0) {
      kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    if (pidfd_ >= 0) close(pidfd_);
  }
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Starts the process; `more` arguments are also used for later restarts. Throws
  /// std::system_error when no process can be created.
  void start(const std::vector<std::string>& more = {}) {
    plan_.arguments.insert(plan_.arguments.end(), more.begin(), more.end());
    std::vector<char*> arguments;
    for (std::string& word : plan_.arguments) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    const int log =
        plan_.log_path.empty()
            ? -1
            : ::open(plan_.log_path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    const pid_t pid = fork();
    if (pid == 0) become(arguments, log);
    const int error = errno;
    if (log >= 0) close(log);
    if (pid < 0) throw std::system_error(error, std::generic_category(), "starting " + plan_.name);
    pid_ = pid;
    pidfd_ = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
    exit_code_.reset();
    started_ = Clock::now();
    restart_at_ = Clock::time_point::max();
  }

  /// Returns what has happened since the last call, as text for the user; none: nothing. Restarts a
  /// failed process after a wait: none at first, then doubling up to five seconds while the process
  /// fails within ten seconds of its start.
  std::optional<std::string> watch() {
    if (pid_ > 0) {
      int status = 0;
      if (waitpid(pid_, &status, WNOHANG) != pid_) return std::nullopt;
      return take_end(status);
    }
    if (stopping_ || Clock::now() < restart_at_) return std::nullopt;
    start();
    ++num_restarts_;
    return plan_.name + " was restarted (" + std::to_string(num_restarts_) + ")";
  }

  /// Asks the process to stop (SIGINT); it is not restarted.
  void ask_to_stop() {
    stopping_ = true;
    if (pid_ > 0) kill(pid_, SIGINT);
  }
  void kill_now() {
    stopping_ = true;
    if (pid_ > 0) kill(pid_, SIGKILL);
  }

  bool running() const { return pid_ > 0; }

  /// File descriptor that becomes readable when the process ends; -1: it is not running.
  int fileno() const { return pidfd_; }

  /// Exit code of a process that ended by itself; 128 + signal for a killed one.
  std::optional<int> exit_code() const { return exit_code_; }

  /// Time of the next restart of a failed process; max: none.
  Clock::time_point restart_at() const { return restart_at_; }

  /// Number of restarts.
  int num_restarts() const { return num_restarts_; }
  const ChildPlan& plan() const { return plan_; }

 private:
  std::string take_end(int status) {
    pid_ = -1;
    if (pidfd_ >= 0) close(pidfd_);
    pidfd_ = -1;
    exit_code_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    std::string text = plan_.name;
    if (WIFSIGNALED(status)) {
      text += std::string(" was killed by signal ") + strsignal(WTERMSIG(status));
    } else if (*exit_code_ == 127) {
      text += ": " + plan_.arguments.front() + " cannot be started; install it beside orchard";
    } else {
      text += " ended with exit code " + std::to_string(*exit_code_);
    }
    const bool is_mistake = *exit_code_ == bus::kExitUsage || *exit_code_ == bus::kExitInput ||
                            *exit_code_ == 127;  // a restart would fail in the same way
    if (stopping_ || *exit_code_ == bus::kExitOk || is_mistake) return text;
    if (Clock::now() - started_ > kLongLife) wait_ = std::chrono::milliseconds(0);
    restart_at_ = Clock::now() + wait_;
    wait_ = std::min(std::max(2 * wait_, kFirstWait), kWaitMax);
    return text;
  }

  ChildPlan plan_;
  pid_t pid_ = -1;
  int pidfd_ = -1;
  bool stopping_ = false;
  int num_restarts_ = 0;
  std::optional<int> exit_code_;
  Clock::time_point started_;
  Clock::time_point restart_at_ = Clock::time_point::max();
  std::chrono::milliseconds wait_{0};
};

/// The last lines of a file, to show the user why a process failed.
std::string last_lines(const std::string& path, int num_lines) {
  std::ifstream file(path);
  std::deque<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    lines.push_back(line);
    if (static_cast<int>(lines.size()) > num_lines) lines.pop_front();
  }
  std::string text;
  for (const std::string& line : lines) text += "    " + line + "\n";
  return text;
}

enum Stage { kDrivers, kDetector, kPose, kMapper, kRecorder };

/// A driver, its channel, and the address of its device in the rig.
struct KnownDriver {
  const char* name;
  std::optional<bus::Channel> channel;  ///< none: converts several channels of other programs
  std::string device;
};

std::vector<KnownDriver> drivers_known(const device::DriversConfig& d) {
  using bus::Channel;
  return {{"orchard-laser-driver", Channel::kScan, d.laser.device},
          {"orchard-rear-laser-driver", Channel::kScanRear, d.laser_rear.device},
          {"orchard-camera-driver", Channel::kImage, d.camera.device},
          {"orchard-odometry-driver", Channel::kOdometry, d.odometry.device},
          {"orchard-imu-driver", Channel::kImu, d.imu.device},
          {"orchard-gnss-driver", Channel::kGnss, d.gnss.device},
          {"orchard-bot-core-adapter", std::nullopt, d.bot_core.lcm_url}};
}

/// Drivers of the sensors with a device in the rig.
std::vector<std::string> drivers_of(const io::Config& config) {
  std::vector<std::string> names;
  for (const KnownDriver& driver : drivers_known(config.drivers)) {
    if (!driver.device.empty()) names.emplace_back(driver.name);
  }
  return names;
}

/// Drivers of the sensors with messages in a log.
std::set<std::string> drivers_played(const std::string& log_path) {
  constexpr std::int64_t kSurvey_us = 20'000'000;  // every sensor sends within this time
  std::set<std::string> names;
  io::LogReader log(log_path);
  std::optional<std::int64_t> end_utime;
  while (const std::optional<io::LogEvent> event = log.next()) {
    if (!end_utime) end_utime = event->timestamp_us + kSurvey_us;
    if (event->timestamp_us > *end_utime) break;
    const std::optional<bus::Channel> channel = bus::find_channel(event->channel);
    for (const KnownDriver& driver : drivers_known({})) {
      if (channel && driver.channel == channel) names.emplace(driver.name);
    }
  }
  return names;
}

/// Resolves a list of names to processes.
std::set<std::string> named(const std::vector<std::string>& names,
                            const std::vector<ChildPlan>& plans) {
  std::set<std::string> found;
  for (const std::string& name : names) {
    std::size_t before = found.size();
    std::vector<std::string> known{"drivers"};
    for (const ChildPlan& plan : plans) {
      known.push_back(plan.name.substr(std::string("orchard-").size()));
      const bool is_meant =
          name == "drivers" ? plan.stage == kDrivers : plan.name == bus::full_process_name(name);
      if (is_meant) found.insert(plan.name);
    }
    if (found.size() == before && name != "drivers") {
      const std::string near = nearest_word(name, known, name.size() / 3 + 2);
      throw io::FileError("--only or --without: this rig has no process \"" + name + "\"" +
                          (near.empty() ? "" : "; did you mean " + near + "?"));
    }
  }
  return found;
}

/// Plans the processes of this machine, in the order of their start. `program_folder`: the folder
/// of the executables. Throws io::FileError for an unknown name and when no process would be
/// started.
std::vector<ChildPlan> plan_launch(const LiveOptions& options, const io::Config& config,
                                   const std::string& program_folder) {
  std::vector<ChildPlan> plans;
  const auto add = [&](const std::string& name, int stage, std::vector<std::string> more = {}) {
    ChildPlan plan;
    plan.name = name;
    plan.stage = stage;
    plan.log_path = options.out_folder + "/logs/" + name + ".log";
    plan.arguments = {program_folder + "/" + name, "--config", options.config_path};
    plan.arguments.insert(plan.arguments.end(), {"--lcm-url", options.lcm_url});
    plan.arguments.insert(plan.arguments.end(), more.begin(), more.end());
    plans.push_back(std::move(plan));
  };
  if (!options.record_folder.empty()) {
    add("orchard-recorder", kRecorder);
    std::vector<std::string>& words = plans.back().arguments;
    words.front() = program_folder + "/orchard";
    words.insert(words.begin() + 1, "record");
    words.insert(words.end(), {"--out", options.record_folder});
    if (!options.robot.empty()) words.insert(words.end(), {"--name", options.robot});
  }
  add("orchard-mapper", kMapper, {"--out", options.out_folder});
  add("orchard-pose", kPose);
  add("orchard-detector", kDetector);
  if (!options.scene.empty()) {
    // A simulated drive waits until all processes listen; the drive of a real robot does not wait.
    std::string listeners;
    for (const ChildPlan& plan : plans) listeners += (listeners.empty() ? "" : ",") + plan.name;
    add("orchard-sim-driver", kDrivers,
        {"--scene", options.scene, "--seed", options.seed, "--speed", options.speed, "--hold",
         "--wait-for", listeners});
  } else if (!options.played_log.empty()) {
    for (const std::string& driver : drivers_played(options.played_log)) {
      add(driver, kDrivers, {"--emulate", options.played_log});
      plans.back().plays = true;
    }
  } else {
    for (const std::string& driver : drivers_of(config)) add(driver, kDrivers);
  }

  // The viewer only displays: no process waits for it.
  if (!options.viewer_address.empty()) {
    std::vector<std::string> words{"--listen", options.viewer_address, "--folder",
                                   options.out_folder};
    if (options.edit) words.insert(words.end(), {"--edit", options.out_folder});
    add("orchard-viewer", kRecorder, words);
  }

  const std::set<std::string> only = named(options.only, plans);
  const std::set<std::string> without = named(options.without, plans);
  const auto is_left_out = [&](const ChildPlan& plan) {
    return (!options.only.empty() && only.count(plan.name) == 0) || without.count(plan.name) > 0;
  };
  plans.erase(std::remove_if(plans.begin(), plans.end(), is_left_out), plans.end());
  if (plans.empty()) {
    throw io::FileError(options.config_path +
                        ": no process to start; name the sensors of this machine in section "
                        "drivers, or change --only and --without");
  }
  return plans;
}

using Clock = std::chrono::steady_clock;

/// Time from the start of the programs that play one log to its first event, so that none of them
/// misses it.
constexpr std::int64_t kPlayAfter_us = 2'000'000;

/// Max time for a stage to stop, in which the mapper writes its whole folder.
constexpr std::chrono::seconds kStopMax{20};

/// The child processes of this machine and their last event.
class Launch {
 public:
  explicit Launch(std::vector<ChildPlan> plans) {
    for (ChildPlan& plan : plans) {
      children_.push_back(std::make_unique<ChildProcess>(std::move(plan)));
    }
    for (const auto& child : children_) {
      if (!child->plan().plays) child->start();
    }
  }

  /// Starts the players of a log once `board` has STATUS of all other processes.
  void play_when_heard(const StatusBoard& board) {
    if (plays_) return;
    const std::vector<ProcessView> heard = board.processes(bus::wall_utime());
    const auto is_ready = [&heard](const std::unique_ptr<ChildProcess>& child) {
      return child->plan().plays || is_heard(child->plan().name, heard);
    };
    if (!std::all_of(children_.begin(), children_.end(), is_ready)) return;
    plays_ = true;
    const std::string start_utime = std::to_string(bus::wall_utime() + kPlayAfter_us);
    for (const auto& child : children_) {
      if (child->plan().plays) child->start({"--emulate-at", start_utime});
    }
  }

  /// Reports processes that ended and restarts those that failed.
  void watch() {
    for (const auto& child : children_) {
      while (const std::optional<std::string> event = child->watch()) say(*event, *child);
    }
  }

  /// Exit code of a process that ended because of its configuration or command line; this ends all.
  std::optional<int> mistake() const {
    for (const auto& child : children_) {
      const std::optional<int> code = child->running() ? std::nullopt : child->exit_code();
      if (code == bus::kExitInput || code == bus::kExitUsage || code == 127) return code;
    }
    return std::nullopt;
  }

  std::vector<pollfd> files() const {
    std::vector<pollfd> files;
    for (const auto& child : children_) {
      if (child->fileno() >= 0) files.push_back({child->fileno(), POLLIN, 0});
    }
    return files;
  }

  Clock::time_point next_restart() const {
    Clock::time_point next = Clock::time_point::max();
    for (const auto& child : children_) {
      if (!child->running()) next = std::min(next, child->restart_at());
    }
    return next;
  }

  /// Stops the processes stage by stage, calling `meanwhile` often. Returns true if all ended by
  /// themselves without error.
  bool stop(const std::function<void()>& meanwhile) {
    int last = 0;
    for (const auto& child : children_) last = std::max(last, child->plan().stage);
    bool well = true;
    for (int stage = 0; stage <= last; ++stage) well = stop_stage(stage, meanwhile) && well;
    return well;
  }

  /// Text of the events: "started 6 processes" first, the newest last.
  const std::string& last_event() const { return last_event_; }
  std::size_t size() const { return children_.size(); }

 private:
  static bool is_heard(const std::string& name, const std::vector<ProcessView>& heard) {
    return std::any_of(heard.begin(), heard.end(),
                       [&name](const ProcessView& view) { return view.status.name == name; });
  }

  void say(const std::string& event, const ChildProcess& child) {
    last_event_ = event;
    std::string words = event;
    const std::optional<int> code = child.running() ? std::nullopt : child.exit_code();
    if (code.value_or(0) != 0) {
      words += "; last lines of its output (" + child.plan().log_path + "):\n" +
               last_lines(child.plan().log_path, 3);
      if (words.back() == '\n') words.pop_back();
    }
    if (!StatusScreen::is_terminal()) std::fprintf(stderr, "orchard live: %s\n", words.c_str());
  }

  bool stop_stage(int stage, const std::function<void()>& meanwhile) {
    const Clock::time_point end = Clock::now() + kStopMax;
    bool well = true;
    for (const auto& child : children_) {
      if (child->plan().stage == stage) child->ask_to_stop();
    }
    for (const auto& child : children_) {
      if (child->plan().stage != stage) continue;
      while (child->running()) {
        meanwhile();
        if (const auto event = child->watch()) say(*event, *child);
        if (Clock::now() >= end) child->kill_now();
        pollfd waiting{child->fileno(), POLLIN, 0};
        if (child->running()) poll(&waiting, 1, 50);
      }
      well = well && child->exit_code().value_or(0) == 0;
    }
    return well;
  }

  std::vector<std::unique_ptr<ChildProcess>> children_;
  std::string last_event_;
  bool plays_ = false;
};

/// Address of the viewer's page: the first free port of this host. Chosen before the viewer starts,
/// so that it stays the same after a restart.
std::string viewer_address() {
  constexpr int kFirstPort = 8420, kPorts = 100;
  for (int port = kFirstPort; port < kFirstPort + kPorts; ++port) {
    const int file = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (file < 0) return {};
    const int yes = 1;  // like the viewer: a recently closed port counts as free
    setsockopt(file, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool is_free =
        ::bind(file, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    close(file);
    if (is_free) return "127.0.0.1:" + std::to_string(port);
  }
  return {};
}

}  // namespace

int run_live(const LiveOptions& given) {
  LiveOptions options = given;
  const io::Config config = io::load_config(options.config_path);
  options.lcm_url = field_url(options);
  options.robot = bus::parse_network(options.lcm_url).robot;
  if (options.out_folder.empty()) {
    options.out_folder =
        "out/live/" + (options.robot.empty() ? "" : options.robot + "-") + start_time_text();
  }
  options.viewer_address = viewer_address();
  const std::vector<ChildPlan> plans = plan_launch(options, config, io::program_folder());
  io::make_folder(options.out_folder + "/logs", "choose another folder with --out");

  bus::StopSignal stop;
  bus::Bus bus(options.lcm_url);
  StatusBoard board(bus::machine_name());
  bus.subscribe_status(
      [&board](const bus::Status& status) { board.note(status, bus::wall_utime()); });
  Launch launch(plans);
  StatusScreen screen;
  std::fprintf(stderr,
               "orchard live: started %zu processes; map and logs in %s; stop with Ctrl-C\n",
               launch.size(), options.out_folder.c_str());
  std::string watch_words;
  if (std::any_of(plans.begin(), plans.end(),
                  [](const ChildPlan& plan) { return plan.name == "orchard-viewer"; })) {
    watch_words = "watch it at http://" + options.viewer_address + "/";
    std::fprintf(stderr, "orchard live: %s\n", watch_words.c_str());
  }
  if (StatusScreen::is_terminal()) std::printf("\033[2J");
  Clock::time_point next_draw = Clock::now();
  const auto draw = [&](const std::string& headline) {
    if (Clock::now() < next_draw) return;
    screen.show(board, headline, bus::wall_utime());
    next_draw = Clock::now() + kRedraw;
  };
  while (!stop.raised() && !launch.mistake()) {
    draw("orchard live " + options.config_path + ": map in " + options.out_folder +
         "; stop with Ctrl-C\n" + (watch_words.empty() ? "" : watch_words + "\n") +
         launch.last_event());
    std::vector<pollfd> files = launch.files();
    files.push_back({stop.fileno(), POLLIN, 0});
    files.push_back({bus.fileno(), POLLIN, 0});
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(
        std::min(next_draw, launch.next_restart()) - Clock::now());
    poll(files.data(), files.size(),
         static_cast<int>(std::clamp<std::int64_t>(wait.count(), 0, 1000)));
    if ((files.back().revents & POLLIN) != 0) bus.handle(0);
    launch.play_when_heard(board);
    launch.watch();
  }
  const std::optional<int> mistake = launch.mistake();
  if (!mistake) std::fprintf(stderr, "orchard live: stopping\n");
  const bool well = launch.stop([&] {
    while (bus.handle(0)) {
    }
    draw("orchard live: stopping\n" + launch.last_event());
  });
  if (mistake) {
    std::fprintf(stderr, "orchard live: %s\n", launch.last_event().c_str());
    return *mistake == 127 ? bus::kExitRuntime : *mistake;
  }
  if (!well)
    std::fprintf(stderr, "orchard live: a process ended with an error; see its output in %s/logs\n",
                 options.out_folder.c_str());
  return well ? bus::kExitOk : bus::kExitRuntime;
}

}  // namespace orchard::cli
