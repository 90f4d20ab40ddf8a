// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace orchard::cli {

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

/// A child process that is monitored, restarted when it fails, and stopped.
class ChildProcess {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ChildProcess(ChildPlan plan);
  ~ChildProcess();  ///< kills the process if it still runs
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Starts the process; `more` arguments are also used for later restarts. Throws
  /// std::system_error when no process can be created.
  void start(const std::vector<std::string>& more = {});

  /// Returns what has happened since the last call, as text for the user; none: nothing. Restarts a
  /// failed process after a wait: none at first, then doubling up to five seconds while the process
  /// fails within ten seconds of its start.
  std::optional<std::string> watch();

  /// Asks the process to stop (SIGINT); it is not restarted.
  void ask_to_stop();
  void kill_now();

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
  std::string take_end(int status);

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
std::string last_lines(const std::string& path, int num_lines);

}  // namespace orchard::cli
