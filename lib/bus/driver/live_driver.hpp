// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/driver/driver.hpp"
#include "bus/node/peer_processes.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"
#include "io/progress_bar.hpp"

namespace orchard::bus {

/// Runs a driver on the network: one thread and one loop that waits for the driver's files and
/// deadline, LCM, STATUS and a stop at the same time, so that none delays another.
class LiveDriver {
 public:
  LiveDriver(Bus& bus, Driver& driver, const std::string& name, const ProcessOptions& options);

  /// Runs until the driver has ended (unless --hold was given) or a stop is requested.
  void run(StopSignal& stop);

 private:
  using Clock = Driver::Clock;
  bool wait_for_others(StopSignal& stop);
  /// Waits for `files`, LCM, `until` or a stop; sends STATUS when it is due.
  void wait(std::vector<pollfd> files, Clock::time_point until, const StopSignal& stop);
  void announce_duration();
  void send(const Message& message);
  void say_condition();
  Status status() const;

  Bus& bus_;
  Driver& driver_;
  ProcessOptions options_;
  ProcessReport report_;
  PeerProcesses peers_;
  std::vector<std::string> missing_;  ///< processes that have not been heard yet
  std::optional<double> duration_s_;
  std::optional<io::ProgressBar> bar_;
  std::optional<std::int64_t> first_utime_;
  std::int64_t num_published_ = 0;
  DriverCondition said_;  ///< as last written to the log
  Clock::time_point said_time_;
};

}  // namespace orchard::bus
