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

/// The other processes on the network, by their STATUS and CONFIG: who runs twice, who has another
/// configuration, whose clock is another.
class Neighbours {
 public:
  using Clock = std::chrono::steady_clock;

  /// `name` and `host` (with its process id) as this process says them in STATUS.
  Neighbours(std::string name, std::string host, std::int64_t config_hash);

  /// `wall_utime`: the wall clock at the receipt. Whether it is of a process that was not known.
  bool note(const Status& status, std::int64_t wall_utime, Clock::time_point now);
  void note(const ConfigNotice& notice, Clock::time_point now);

  /// Compares the wall clock with the steady one: call it once a second. How far it was set since
  /// the last time [s]; 0 when it was not.
  double check_clock(std::int64_t wall_utime, Clock::time_point now);

  /// The same program elsewhere, "orchard-mapper on robot:4711"; empty when there is none.
  std::string twin(Clock::time_point now) const;

  /// Whether that twin has run for longer than this process, which has sent `own_seq` STATUS.
  bool twin_is_older(std::int32_t own_seq, Clock::time_point now) const;

  /// "orchard-sim-driver on robot:12, orchard-sim-driver on laptop:99": those whose name has
  /// `part`.
  std::string named(const std::string& part, Clock::time_point now) const;

  /// What people should know, in words; empty when all is well.
  std::string text(Clock::time_point now) const;

 private:
  struct Process {
    std::string name;
    std::string host;
    std::int32_t seq = 0;
    Clock::time_point heard;
    std::deque<std::int64_t> offsets_us;  ///< its clock minus ours, by the newest STATUS
  };
  struct OtherConfig {
    std::int64_t hash = 0;
    Clock::time_point heard;
  };
  const Process* find_twin(Clock::time_point now) const;

  std::string name_;
  std::string host_;
  std::int64_t config_hash_;
  std::vector<Process> processes_;
  std::map<std::string, OtherConfig> configs_;  ///< by the name of who has it
  std::int64_t clock_base_us_ = 0;              ///< wall clock minus steady clock
  bool has_clock_base_ = false;
  double clock_step_s_ = 0.0;
  Clock::time_point clock_step_time_;
};

}  // namespace orchard::bus
