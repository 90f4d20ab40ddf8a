// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/live.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "bus/bus.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/process/process.hpp"
#include "cli/field/field_url.hpp"
#include "cli/field/start_time.hpp"
#include "cli/field/status_board.hpp"
#include "cli/field/status_screen.hpp"
#include "cli/program_folder.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"

namespace orchard::cli {
namespace {

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
  if (options.out_folder.empty()) options.out_folder = "out/live/" + start_time_text();
  options.viewer_address = viewer_address();
  const std::vector<ChildPlan> plans = plan_launch(options, config, program_folder());
  io::make_folder(options.out_folder + "/logs", "choose another folder with --out");
  const std::string url = field_url(options.lcm_url, options.config_path);

  bus::StopSignal stop;
  bus::Bus bus(url);
  StatusBoard board;
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
