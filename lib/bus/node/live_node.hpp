// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "bus/bus.hpp"
#include "bus/node/node_host.hpp"
#include "bus/node/process.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"

namespace orchard::bus {

/// A node on the network: one thread, one event loop, until a signal ends it.
class LiveNode {
 public:
  LiveNode(Bus& bus, Node& node, const std::string& name, const io::EffectiveConfig& config,
           SaveHook save);

  /// Runs until a stop is asked for, then takes in what has already arrived, flushes and saves.
  /// Throws BusError, what the node throws, and std::runtime_error when that last save failed.
  void run(StopSignal& stop);

 private:
  using Clock = std::chrono::steady_clock;
  void log_missing_inputs();
  void take(const Message& message);
  void drain();
  void handle_oldest();
  void save_when_due();
  /// "", or what was thrown.
  std::string save_now(SaveKind kind);
  Status status() const;
  std::string waiting_text() const;

  Bus& bus_;
  Node& node_;
  NodeHost host_;
  ProcessReport report_;
  SaveHook save_;
  Clock::time_point next_save_;
  Clock::time_point next_full_save_;
  bool changed_ = false;
  Clock::time_point start_;
  std::deque<std::pair<Clock::time_point, Message>> inbox_;
  int num_images_ = 0;  ///< in the inbox
  std::string logged_missing_;
};

}  // namespace orchard::bus
