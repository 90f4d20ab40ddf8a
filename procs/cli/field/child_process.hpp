// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace orchard::cli {

/// What is to be started, and when it is stopped.
struct ChildPlan {
  std::string name;                    ///< of the process: "orchard-detector"
  std::vector<std::string> arguments;  ///< the program's path first
  std::string log_path;                ///< its standard output and error are appended here
  /// Stopped in rising order, each stage when the one before has ended: who sends before who takes.
  int stage = 0;
  /// Plays a log: it starts when all others are heard of, so that they take all that it sends.
  bool plays = false;
};

/// A process that is started, watched, started again when it fails, and stopped.
class ChildProcess {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ChildProcess(ChildPlan plan);
  ~ChildProcess();  ///< kills what still runs
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Starts it, with `more` arguments from then on. Throws std::system_error when no process can be
  /// made.
  void start(const std::vector<std::string>& more = {});

  /// What has happened since the last call, in words for a person; none: nothing. Starts it again
  /// when it has failed and the wait is over: at once the first time, then after twice as long as
  /// before, up to five seconds, while it fails within ten seconds of its start.
  std::optional<std::string> watch();

  /// Asks it to stop (SIGINT): it is not started again.
  void ask_to_stop();
  void kill_now();

  bool running() const { return pid_ > 0; }

  /// A file descriptor that becomes readable when it ends; -1 when it does not run.
  int fileno() const { return pidfd_; }

  /// Of a process that has ended by itself: its exit code, 128 + signal for one that was killed.
  std::optional<int> exit_code() const { return exit_code_; }

  /// When a failed one is to be started again; max: it is not.
  Clock::time_point restart_at() const { return restart_at_; }

  /// How often it was started again.
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

/// The last lines of a file, for a person who wants to know why a process failed.
std::string last_lines(const std::string& path, int num_lines);

}  // namespace orchard::cli
