// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <future>
#include <string>

#include "bus/bus.hpp"
#include "bus/node/live_inputs.hpp"
#include "bus/node/node.hpp"
#include "bus/node/peer_processes.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"

namespace orchard::bus {

/// Runs a node on the network: one thread with one event loop, until a signal ends it.
class LiveNode {
 public:
  /// `alone`: refuses to run when a process of the same name is already on the network.
  LiveNode(Bus& bus, Node& node, const std::string& name, const io::EffectiveConfig& config,
           SaveHook save, bool alone = false);

  /// Runs until a stop is requested. Then handles the messages that have already arrived (for at
  /// most a second), flushes the node and saves. Throws BusError, whatever the node throws, and
  /// std::runtime_error when the last save failed or a process of the same name was running before.
  void run(StopSignal& stop);

 private:
  using Clock = std::chrono::steady_clock;
  void log_missing_inputs();
  void take(Message&& message, Bytes bytes);
  void drain();
  bool handle_next();
  void wait(StopSignal& stop);
  void process_arrived();
  void check_peers(StopSignal& stop);
  void require_single_instance() const;
  void report();
  void save_when_due();
  void begin_save(SaveKind kind);
  void end_save();
  void note_outcome(std::string mistake);
  Status status() const;
  std::string waiting_text() const;
  Level describe_inputs(std::string& text) const;

  Bus& bus_;
  Node& node_;
  NodeHost host_;
  ProcessReport report_;
  SaveHook save_;
  Clock::time_point next_save_;
  Clock::time_point next_full_save_;
  std::future<void> writing_;  ///< of the last save; not valid: it has ended
  bool changed_ = false;
  std::string save_mistake_;  ///< why the last save failed; empty: it did not
  Clock::time_point start_;
  Inbox inbox_;
  InputWatch inputs_;
  PeerProcesses peers_;
  bool alone_;
  bool has_started_ = false;
  bool outputs_flow_ = true;  ///< outputs were sent between the last two reports; true at first
  std::int64_t num_published_before_ = 0;
  std::int64_t num_dropped_before_ = 0;
  std::int64_t num_dropped_lately_ = 0;
  std::deque<std::int64_t> num_late_;  ///< num_late of the node, once a second, for the last ten
  std::string waited_for_before_;
  std::string logged_warning_;
  std::string logged_missing_;
};

}  // namespace orchard::bus
