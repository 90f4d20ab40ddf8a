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

/// Exit codes of every program.
enum ExitCode : int { kExitOk = 0, kExitRuntime = 1, kExitUsage = 2, kExitInput = 3 };

/// A command-line option beyond the common ones (--config, --lcm-url, --log-level, --version,
/// --help, --print-config with --all; --lockstep for nodes; --speed, --wait-for for drivers).
struct ExtraOption {
  std::string flag;        ///< as typed: "--out"
  std::string value_name;  ///< "DIR"; empty for a switch, whose value becomes "true"
  std::string help;
  std::string* value = nullptr;  ///< filled when given
};

struct ProcessInfo {
  std::string name;         ///< of the executable: "orchard-detector"
  std::string description;  ///< the first lines of --help
  std::vector<ExtraOption> options;
  /// Fills the configuration where no --config is given; empty: the built-in defaults stay.
  std::function<void()> load_default;
  bool alone = false;        ///< refuses to run where another of its name does already
  bool* lockstep = nullptr;  ///< set when --lockstep is given
};

/// How much a save may cost.
enum class SaveKind {
  kQuick,  ///< live, about every second: the node waits for it
  kFull,   ///< live, every half minute, and only when no message waits
  kFinal,  ///< once, after the flush
};

/// A node's state is to be saved.
struct SaveRequest {
  SaveKind kind = SaveKind::kFinal;
  TrafficCounts traffic;  ///< so far
};

/// Called when something may have changed since the last time. Live, what it throws is shown in
/// STATUS and the process goes on.
using SaveHook = std::function<void(Node& node, const SaveRequest& request)>;

/// Runs one node as a process: parses options, loads the configuration, opens the bus, hands the
/// node what the guard lets through, sends its outputs, STATUS and CONFIG, stops at SIGINT or
/// SIGTERM with a flush. `make_node` is called once `config` is loaded. Returns the exit code;
/// prints every error in one clear sentence.
int run_node_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                     const std::function<std::unique_ptr<Node>()>& make_node,
                     const SaveHook& save = {});

/// Runs a source as a process: the same, publishing what the source gives at its pace (--speed).
int run_driver_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Source>()>& make_source);

/// Runs the driver of a device as a process: the same, at the device's own pace. `make_driver` may
/// throw io::ConfigError, io::FileError and std::invalid_argument (an option that is none).
int run_device_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Driver>()>& make_driver);

}  // namespace orchard::bus
