// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bus/network.hpp"
#include "bus/node/node.hpp"
#include "io/config/config_file.hpp"

namespace CLI {
class App;
}

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
  kQuick,  ///< live, about once a second
  kFull,   ///< live, every half minute, only while no message waits
  kFinal,  ///< once, after the flush
};

/// Request to save a node's state.
struct SaveRequest {
  SaveKind kind = SaveKind::kFinal;
  TrafficCounts traffic;  ///< counts so far
};

/// The writing of what a SaveHook has taken from its node; in a live process it runs in a thread of
/// its own, beside the node. Empty: nothing is to be written.
using Writing = std::function<void()>;

/// Takes from a node what is to be saved and returns its writing, which no longer needs the node;
/// called when the node may have changed since the last save, and not before the last writing has
/// ended. In a live process an exception of either is reported in STATUS and the process continues.
using SaveHook = std::function<Writing(Node& node, const SaveRequest& request)>;

/// Options of the command line that every process has.
struct CommonOptions : NetworkOptions {
  std::string log_level = "info";
  bool print_config = false;
  bool print_all = false;  ///< with print_config: the expert keys, too
};

/// Adds --lcm-url and --robot.
void add_network_options(CLI::App& app, NetworkOptions& options);

/// Adds those, --log-level, --print-config and --all.
void add_common_options(CLI::App& app, CommonOptions& options);

/// Sends log lines of at least this level to stderr, each with the program's name; stdout is
/// reserved for output that was requested.
void set_up_log(const std::string& program, const std::string& level);

/// Full name of a process: "pose" is "orchard-pose".
std::string full_process_name(const std::string& name);

enum class ProcessKind {
  kNode,
  kDriver,  ///< publishes a paced source
  kDevice,  ///< publishes a sensor at its own pace
};

/// Parsed command line of a process.
struct ProcessOptions {
  io::EffectiveConfig config;  ///< effective configuration, with the lcm.url in use
  bool lockstep = false;
  double speed = 1.0;
  std::vector<std::string> wait_for;  ///< full names of processes
  bool hold = false;
};

/// Version of the software.
std::string_view version();

/// Selects the LCM network: --lcm-url if given, else the rig's URL, else LCM_DEFAULT_URL, else the
/// built-in default; with --robot the channels of that robot on it. Returns the origin of the URL
/// in words.
const char* choose_url(const NetworkOptions& given, bool has_rig, io::LcmConfig& lcm);

/// Loads the rig at `path` (empty: keeps the defaults), logs the reader's warnings and prints its
/// errors. Returns false when the rig is invalid.
bool load_config(const std::string& program, const std::string& path, io::ConfigFile& config);

/// Parses the command line, loads the configuration, prints errors in either and sets the log
/// level. Returns the exit code if the program must end here (also after --help).
std::optional<int> read_options(int argc, char** argv, const ProcessInfo& info, ProcessKind kind,
                                io::ConfigFile& config, ProcessOptions& options);

}  // namespace orchard::bus
