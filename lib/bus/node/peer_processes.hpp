// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bus/messages/service_messages.hpp"

namespace orchard::bus {

/// Tracks the other processes on the network by their STATUS and CONFIG. Detects a second process
/// of the same name, differing configurations and clock offsets.
class PeerProcesses {
 public:
  using Clock = std::chrono::steady_clock;

  /// `name` and `host` (with process id) as this process sends them in STATUS.
  PeerProcesses(std::string name, std::string host, std::int64_t config_hash);

  /// Records a STATUS received at `wall_utime` (wall clock). Returns whether its process was
  /// unknown.
  bool note(const Status& status, std::int64_t wall_utime, Clock::time_point now);
  void note(const ConfigNotice& notice, Clock::time_point now);

  /// Compares the wall clock with the steady clock; call it once a second. Returns by how much the
  /// wall clock was set since the last call [s], or 0.
  double check_clock(std::int64_t wall_utime, Clock::time_point now);

  /// Another running process of the same name ("orchard-mapper on robot:4711"), or empty.
  std::string duplicate(Clock::time_point now) const;

  /// Whether that process has been running longer than this one, which has sent `own_seq` STATUS.
  bool duplicate_is_older(std::int32_t own_seq, Clock::time_point now) const;

  /// Lists the processes whose name contains `part`: "orchard-sim-driver on robot:12,
  /// orchard-sim-driver on laptop:99".
  std::string named(const std::string& part, Clock::time_point now) const;

  /// Describes differing configurations and clock problems for the user; empty when there are none.
  std::string text(Clock::time_point now) const;

 private:
  struct Process {
    std::string name;
    std::string host;
    std::int32_t seq = 0;
    Clock::time_point heard;
    std::deque<std::int64_t> offsets_us;  ///< its clock minus ours, of recent STATUS
  };
  struct OtherConfig {
    std::int64_t hash = 0;
    Clock::time_point heard;
  };
  const Process* find_duplicate(Clock::time_point now) const;

  std::string name_;
  std::string host_;
  std::int64_t config_hash_;
  std::vector<Process> processes_;
  std::map<std::string, OtherConfig> configs_;  ///< by process name
  std::int64_t clock_base_us_ = 0;              ///< wall clock minus steady clock
  bool has_clock_base_ = false;
  double clock_step_s_ = 0.0;
  Clock::time_point clock_step_time_;
};

}  // namespace orchard::bus
