// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "bus/bus.hpp"
#include "io/config/config_file.hpp"

namespace orchard::bus {

/// Reports the process state to a supervisor by systemd's notification protocol (sd_notify(3)): one
/// datagram to the socket named by NOTIFY_SOCKET. Does nothing when that variable is not set.
class ServiceNotifier {
 public:
  ServiceNotifier();
  ~ServiceNotifier();
  ServiceNotifier(const ServiceNotifier&) = delete;
  ServiceNotifier& operator=(const ServiceNotifier&) = delete;

  /// Reports READY: initialization is complete.
  void ready();

  /// Feeds the watchdog; call it from the process's loop. `text` is shown by systemctl status.
  void alive(const std::string& text);

 private:
  void send(const std::string& state);
  int fileno_ = -1;
  std::string said_;
};

/// Wall clock time [us]; for messages about processes, never for measurements.
std::int64_t wall_utime();

/// The name of this machine.
std::string machine_name();

/// The machine in the host of a STATUS: "robot" of "robot:4711".
std::string machine_of(const std::string& host);

/// Publishes the state of a process: STATUS once a second, CONFIG at the start and every ten
/// seconds (none for a process without a rig), and the watchdog of a supervisor.
class ProcessReport {
 public:
  ProcessReport(Bus& bus, std::string name, const io::EffectiveConfig& config);

  /// Records that one input was handled and its outputs were sent, `latency_s` after its arrival.
  void note_input(double latency_s);

  /// Sets an error that STATUS shows until it is cleared with an empty text.
  void set_error(std::string text) { error_ = std::move(text); }

  /// Machine and process id as sent in STATUS: "robot:4711".
  const std::string& host() const { return host_; }

  /// Number of STATUS messages sent.
  std::int32_t num_sent() const { return status_seq_; }

  /// Makes STATUS (and CONFIG) due now, because a new process appeared or something changed, unless
  /// they were sent a moment ago.
  void send_soon(bool with_config);

  bool due() const { return Clock::now() >= next_status_; }
  int ms_until_due() const;

  /// Sends STATUS with the given counts and level, and CONFIG when it is due. Period, latency,
  /// names and times are filled in here.
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
