// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "bus/bus.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/process_report.hpp"
#include "bus/driver/source.hpp"
#include "bus/node/stop_signal.hpp"

namespace orchard::bus {

/// A source on the network: publishes each message when its time has come.
class LiveDriver {
 public:
  LiveDriver(Bus& bus, Source& source, const std::string& name, const ProcessOptions& options);

  /// Runs until the source has no more (and no --hold was asked for) or a stop is asked for.
  void run(StopSignal& stop);

 private:
  using Clock = std::chrono::steady_clock;
  /// Lets time pass until `until`, with STATUS and incoming messages; false when stopped.
  bool wait_until(Clock::time_point until, StopSignal& stop);
  bool wait_for_others(StopSignal& stop);
  Status status() const;

  Bus& bus_;
  Source& source_;
  ProcessOptions options_;
  ProcessReport report_;
  std::vector<std::string> missing_;  ///< processes not heard of yet
  std::int64_t num_published_ = 0;
  bool ended_ = false;
};

}  // namespace orchard::bus
