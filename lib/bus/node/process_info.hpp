// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bus/node/node.hpp"
#include "bus/node/traffic_counts.hpp"

namespace orchard::bus {

/// Exit codes of all programs.
enum ExitCode : int { kExitOk = 0, kExitRuntime = 1, kExitUsage = 2, kExitInput = 3 };

/// A command-line option in addition to the common ones (--config, --lcm-url, --log-level,
/// --version, --help, --print-config with --all; --lockstep for nodes; --speed, --wait-for for
/// drivers).
struct ExtraOption {
  std::string flag;        ///< as typed: "--out"
  std::string value_name;  ///< "DIR"; empty for a switch, whose value becomes "true"
  std::string help;
  std::string* value = nullptr;  ///< set when the option is given
};

struct ProcessInfo {
  std::string name;         ///< of the executable: "orchard-detector"
  std::string description;  ///< the first lines of --help
  std::vector<ExtraOption> options;
  /// Fills the configuration when no --config is given; if empty, the built-in defaults remain.
  std::function<void()> load_default;
  bool alone = false;        ///< refuses to run when a process of the same name is already running
  bool* lockstep = nullptr;  ///< set when --lockstep is given
};

/// Kind of save, which limits how long it may take.
enum class SaveKind {
  kQuick,  ///< live, about once a second; the node waits for it
  kFull,   ///< live, every half minute, only while no message waits
  kFinal,  ///< once, after the flush
};

/// Request to save a node's state.
struct SaveRequest {
  SaveKind kind = SaveKind::kFinal;
  TrafficCounts traffic;  ///< counts so far
};

/// Saves a node's state; called when it may have changed since the last save. In a live process an
/// exception is reported in STATUS and the process continues.
using SaveHook = std::function<void(Node& node, const SaveRequest& request)>;

}  // namespace orchard::bus
