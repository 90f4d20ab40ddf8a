// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/driver/driver.hpp"
#include "bus/driver/source.hpp"
#include "bus/node/node.hpp"
#include "bus/node/traffic_counts.hpp"
#include "io/config/config_file.hpp"

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

/// Runs one node as a process: parses the options, loads the configuration, opens the bus, passes
/// validated messages to the node, publishes its outputs, STATUS and CONFIG, and flushes the node
/// on SIGINT or SIGTERM. `make_node` is called after `config` is loaded. Prints every error as one
/// sentence and returns the exit code.
int run_node_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                     const std::function<std::unique_ptr<Node>()>& make_node,
                     const SaveHook& save = {});

/// Runs a source as a process in the same way, publishing its messages at their pace (--speed).
int run_driver_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Source>()>& make_source);

/// Runs a device driver as a process in the same way, at the device's pace. `make_driver` may throw
/// io::ConfigError, io::FileError and std::invalid_argument (an invalid option).
int run_device_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Driver>()>& make_driver);

}  // namespace orchard::bus
