// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/field/field.hpp"
#include "evaluation/map_alignment.hpp"
#include "evaluation/trajectory_evaluation.hpp"

namespace orchard::cli {

struct EchoOptions : FieldOptions {
  std::string channel;     ///< such as SCAN
  bool json = false;       ///< one JSON object per line instead of text
  std::int64_t count = 0;  ///< ends after this many messages; 0: at Ctrl-C
};

/// Prints the messages of a channel, one line each, until stopped. Text shortens arrays longer than
/// eight; JSON has them whole, except the bytes of a picture. Returns the exit code.
[[gnu::weak]] int run_echo(const EchoOptions& options);

/// `orchard import FOLDER|RAWLOG|BAG...|LOG --out LOG`.
struct ImportOptions {
  /// A recording folder (with sensors.yaml), an MRPT rawlog, an LCM log of a robot with libbot's
  /// types, or one or more ROS bags (files, or folders of rosbag2).
  std::vector<std::string> source_paths;
  std::string out_path;
  std::string config_path;   ///< rig whose drivers.bot_core tells how to read an LCM log
  std::string rig_out_path;  ///< rig to write: --config with what the recording tells; empty: none
  std::vector<std::string> topics;  ///< KIND=TOPIC, for bags
  double slice_height_m = 0.0;      ///< for clouds, above the scanner
  double slice_thickness_m = 0.3;
};

/// Converts a recording to an LCM log; returns the exit code. Throws io::FileError.
[[gnu::weak]] int run_import(const ImportOptions& options);

/// `orchard log info|check|config|repair|split LOG`.
struct LogOptions {
  std::string log_path;
  std::vector<std::string> log_paths;  ///< for info, check, split instead: one log, or its parts
  std::string out_path;                ///< for repair; for split a folder
  bool json = false;                   ///< for info and check
  std::string process;  ///< for config: the rig of this process; empty: the common one
};

/// Prints the content of a log: channels, counts, rates, times. Returns the exit code.
[[gnu::weak]] int run_log_info(const LogOptions& options);

/// Prints all faults of a log; returns exit code 3 when there are any.
[[gnu::weak]] int run_log_check(const LogOptions& options);

/// Prints the rig stored in a log (CONFIG) as YAML for --config.
[[gnu::weak]] int run_log_config(const LogOptions& options);

/// Writes a new log with all readable messages. Refuses to overwrite the old one.
[[gnu::weak]] int run_log_repair(const LogOptions& options);

/// Writes a log for each robot of a log that holds several, ROBOT.lcm with the channels' own names,
/// and unnamed.lcm with the rest. Refuses a log without a robot's name.
[[gnu::weak]] int run_log_split(const LogOptions& options);

/// `orchard log mcap LOG... --out FILE`.
struct LogMcapOptions {
  std::vector<std::string> log_paths;
  std::string map_path;     ///< map folder or map.csv of the log; empty: none
  std::string config_path;  ///< empty: the rig stored in the log
  std::string out_path;
};

/// Converts a log, and its map, to messages of ROS 2 in MCAP for Foxglove, RViz and rosbag2;
/// returns the exit code. Throws io::FileError and io::ConfigError.
[[gnu::weak]] int run_log_mcap(const LogMcapOptions& options);

/// `orchard simulate --scene tubes|orchard|park|yard --seed N --out LOG`.
struct SimulateOptions {
  std::string scene;
  std::uint64_t seed = 1;
  std::string out_path;
  std::string truth_path;   ///< CSV of the true objects; empty: do not write
  std::string poses_path;   ///< CSV of the true poses of base; empty: do not write
  std::string config_path;  ///< empty: the scene's own rig
  double from_s = 0.0;      ///< start of the log in scene time
  double duration_s = 0.0;  ///< of the log; 0: until the end of the scene
};

/// Writes a log of a simulated drive, and its truth; returns the exit code. Equal options give
/// identical bytes. Throws io::FileError and io::ConfigError.
[[gnu::weak]] int run_simulate(const SimulateOptions& options);

/// `orchard simulate --scene board`: writes the log for `orchard calibrate laser-camera`. The rig's
/// own `camera` is the truth; there is no map, so --truth and --poses are rejected.
[[gnu::weak]] int run_simulate_board(const SimulateOptions& options);

struct DoctorOptions : FieldOptions {
  bool json = false;
};

/// Checks this machine for LCM's needs (multicast route, loopback, sockets, buffers, traffic) and
/// prints each finding as OK, WARN or FAIL with the command that fixes it. Returns 0 when nothing
/// failed, 1 otherwise, 2 for an invalid URL.
[[gnu::weak]] int run_doctor(const DoctorOptions& options);

/// `orchard overlay LOG --at TIME --out PNG`.
struct OverlayOptions {
  std::string log_path;
  double at = 0.0;          ///< seconds from the log's first message, or an absolute utime [us]
  std::string config_path;  ///< empty: the rig stored in the log
  std::string out_path;
};

/// Draws the scan points and the detector's results onto the picture nearest to a time; returns the
/// exit code. Throws io::FileError and io::ConfigError, and then writes nothing.
[[gnu::weak]] int run_overlay(const OverlayOptions& options);

/// `orchard evaluate MAP --truth CSV`.
struct EvaluateOptions {
  std::string map_path;  ///< a map.csv, or the folder that holds one
  std::string truth_path;
  std::string poses_path;  ///< true poses, to evaluate trajectory.csv; empty: do not
  double gate_m = 0.3;     ///< max distance of a landmark from its true object
  bool align = false;      ///< register the map to the truth first, by its trees
  evaluation::AlignmentSearch search;
  bool json = false;
  bool check = false;  ///< exit 1 unless the map is perfect
};

/// Prints the paper's tables with the error against truth; returns the exit code. Throws
/// io::FileError for missing or invalid files.
[[gnu::weak]] int run_evaluate(const EvaluateOptions& options);

/// `orchard evaluate trajectory TRAJECTORY --truth CSV`.
struct EvaluateTrajectoryOptions {
  std::string trajectory_path;  ///< a trajectory.csv, or the folder that holds one
  std::string truth_path;
  std::string rows_path;  ///< map or survey of the rows, in the truth's frame; empty: none
  bool align = false;
  bool align_origin = false;
  double gap_max_s = 0.0;  ///< 0 = three median intervals of the truth
  evaluation::TrajectoryRules rules;
  bool json = false;
};

/// Prints absolute and relative errors as evo computes them, and those across the rows; returns the
/// exit code: 1 when no poses could be compared. Throws io::FileError for missing or invalid files.
[[gnu::weak]] int run_evaluate_trajectory(const EvaluateTrajectoryOptions& options);

/// `orchard evaluate localisation LOG --map MAP`.
struct EvaluateLocalisationOptions {
  std::vector<std::string> log_paths;
  std::string map_path;     ///< map folder, map.csv or survey; empty: the rig's own prior map
  std::string config_path;  ///< empty: the rig stored in the log
  std::string truth_path;   ///< track in the map's frame; empty: POSE_FIX of the log
  double truth_sd_m = 0.02;
  bool start_known = false;  ///< starts at the first true pose instead of searching the whole map
  std::string out_folder;    ///< empty: only prints
  bool quiet = false;
  bool json = false;
};

/// Locates a drive in a map without its fixes, and prints how far it could have been driven so;
/// returns the exit code. Throws io::FileError and io::ConfigError.
[[gnu::weak]] int run_evaluate_localisation(const EvaluateLocalisationOptions& options);

}  // namespace orchard::cli
