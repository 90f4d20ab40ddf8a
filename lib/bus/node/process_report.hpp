// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "bus/bus.hpp"
#include "bus/node/service_notifier.hpp"
#include "io/config/config_file.hpp"

namespace orchard::bus {

/// Wall clock, for what is about processes and never about measurements [us].
std::int64_t wall_utime();

/// Tells the world how a process is: STATUS once a second, CONFIG at the start and every ten
/// seconds (none for a process without a rig), and a supervisor's watchdog.
class ProcessReport {
 public:
  ProcessReport(Bus& bus, std::string name, const io::EffectiveConfig& config);

  /// One input was handed to the node and its outputs were sent, `latency_s` later.
  void note_input(double latency_s);

  /// Something went wrong that people must see; stays until cleared with an empty text.
  void set_error(std::string text) { error_ = std::move(text); }

  /// "robot:4711": the machine and the process, as STATUS says them.
  const std::string& host() const { return host_; }

  /// How many STATUS were sent.
  std::int32_t num_sent() const { return status_seq_; }

  /// STATUS and CONFIG are due now (somebody new is there to read them, or something changed),
  /// unless they were sent a moment ago.
  void hurry(bool with_config);

  bool due() const { return Clock::now() >= next_status_; }
  int ms_until_due() const;

  /// Sends STATUS with the given counts and level (periods, names and times are filled in here),
  /// and CONFIG when it is due.
  void send(Status status);

 private:
  using Clock = std::chrono::steady_clock;
  Bus& bus_;
  ServiceNotifier supervisor_;
  std::string name_;
  std::string host_;
  ConfigNotice notice_;
  std::string error_;
  Clock::time_point next_status_;
  Clock::time_point next_config_;
  Clock::time_point last_status_;
  std::int32_t status_seq_ = 0;
  std::int64_t num_inputs_ = 0;  ///< since the last STATUS
  double latency_sum_s_ = 0.0;
  double latency_max_s_ = 0.0;
};

}  // namespace orchard::bus
