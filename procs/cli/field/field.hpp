// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>
#include <string>
#include <vector>

#include "bus/network.hpp"

namespace orchard::cli {

/// Options of a command that uses the LCM network.
struct FieldOptions : bus::NetworkOptions {
  std::string config_path;  ///< of the rig; empty: none
};

/// Selects the LCM network: --lcm-url when given, else the rig's, else LCM_DEFAULT_URL, else the
/// built-in one; with --robot the channels of that robot. Prints the choice and its reason on
/// standard error. Throws io::ConfigError.
std::string field_url(const FieldOptions& options);

/// The local time now as a name for files and folders: "20261122-143005".
inline std::string start_time_text() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[32];
  std::strftime(text, sizeof(text), "%Y%m%d-%H%M%S", &local);
  return text;
}

/// Command-line options of `orchard live`.
struct LiveOptions : FieldOptions {
  std::string out_folder;         ///< map folder; empty: out/live/DATE, or ROBOT-DATE
  std::string record_folder;      ///< empty: no recording
  std::vector<std::string> only;  ///< processes by name, with or without "orchard-"; "drivers"
  std::vector<std::string> without;
  std::string scene;  ///< orchard-sim-driver in place of the rig's drivers
  std::string seed = "1";
  std::string speed = "1";     ///< speed of the simulated drive relative to real time
  std::string played_log;      ///< log that emulated devices play, each in its own protocol
  std::string viewer_address;  ///< ADDRESS:PORT of the viewer's page; empty: none
  bool edit = false;           ///< users may correct the map on that page
};

/// Starts the processes of this machine, keeps them running, and shows their status. At Ctrl-C
/// stops them in order, so that the map contains all measurements. Returns 0 when all ended without
/// error.
[[gnu::weak]] int run_live(const LiveOptions& options);

struct RecordOptions : FieldOptions {
  std::string folder = "out/recordings";
  std::string name = "drive";
  double split_mb = 500.0;
  double keep_gb = 0.0;
};

/// Records every channel until Ctrl-C and sends STATUS as orchard-recorder.
[[gnu::weak]] int run_record(const RecordOptions& options);

struct StatusOptions : FieldOptions {
  bool once = false;
  bool json = false;
};

/// Shows all processes of all hosts until Ctrl-C. `once`: prints them after 2.5 s and returns 1
/// when one needs attention or none was heard.
[[gnu::weak]] int run_status(const StatusOptions& options);

}  // namespace orchard::cli
