// SPDX-License-Identifier: BSD-3-Clause
#include "log_player/player.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <utility>

#include "bus/node/process_options.hpp"
#include "io/file_error.hpp"
#include "log_player/replay_rig.hpp"

namespace orchard::procs {
namespace {

constexpr const char* kName = "orchard-log-player";

constexpr const char* kDescription =
    "Replay the sensor channels of an LCM log (SCAN, IMAGE, ODOMETRY, GNSS, POSE_FIX).\n"
    "\n"
    "--in-process (default): runs detector, pose and mapper in this program; fast, deterministic.\n"
    "--lockstep: sends to the real processes, each started with --lockstep on the same LCM URL, a\n"
    "  few messages at a time, and waits until all their results have arrived; deterministic.\n"
    "--speed X: sends in real time or X times faster, for viewing; messages may be lost, and the\n"
    "  result is not deterministic.";

constexpr const char* kFooter =
    "Exit codes: 0 replayed (with --verify: and equal), 1 runtime failure, no answer of a process, "
    "or\n"
    "a difference, 2 bad command line, 3 bad configuration or log.";

/// Chooses the rig of the replay and prints its notes; false on failure.
bool take_replay_rig(PlayerOptions& options, const std::string& config_path) {
  try {
    ReplayRig rig = choose_rig(options.log_path, config_path);
    for (const std::string& note : rig.notes) spdlog::warn("{}", note);
    options.rig = io::RigFile(std::move(rig.config));
    return true;
  } catch (const io::ConfigError& error) {
    for (const std::string& problem : error.problems()) std::cerr << problem << "\n";
    std::cerr << kName << ": " << error.problems().size() << " error(s) in the configuration\n";
  } catch (const io::FileError& error) {
    std::cerr << kName << ": " << error.what() << "\n";
  }
  return false;
}

}  // namespace

std::optional<int> read_player_options(int argc, char** argv, PlayerOptions& options) {
  CLI::App app(kDescription, kName);
  app.footer(kFooter);
  app.set_version_flag("-V,--version", std::string(kName) + " " + std::string(bus::version()));
  std::string config_path;
  bus::CommonOptions common;
  bool in_process = false;
  bool lockstep = false;
  app.add_option("log", options.log_path, "LCM log to replay")->option_text("LOG");
  auto* in_process_flag = app.add_flag("--in-process", in_process,
                                       "run detector, pose and mapper in this program (default)");
  auto* lockstep_flag = app.add_flag("--lockstep", lockstep,
                                     "replay through processes that were started with --lockstep");
  auto* speed =
      app.add_option("--speed", options.process.speed, "replay in real time, faster by this factor")
          ->option_text("FACTOR")
          ->check(CLI::Range(1e-3, 1e3));
  lockstep_flag->excludes(in_process_flag)->excludes(speed);
  speed->excludes(in_process_flag);
  app.add_option("--config", config_path, "configuration of the rig [the one in LOG]")
      ->option_text("FILE");
  app.add_option("--out", options.out_path, "write all derived messages to this log")
      ->option_text("FILE")
      ->excludes(speed);
  app.add_flag("--verify", options.verify,
               "compare the derived messages byte by byte with those in LOG")
      ->excludes(speed);
  app.add_flag("--strict", options.replay.strict, "refuse a log with damage or invalid messages");
  app.add_option("--from", options.replay.from_s, "start this many seconds into the log")
      ->option_text("SECONDS");
  app.add_option("--to", options.replay.to_s, "end this many seconds into the log")
      ->option_text("SECONDS");
  app.add_option("--nodes", options.nodes,
                 "lockstep: processes that take part [detector,pose,mapper]")
      ->option_text("NAMES")
      ->delimiter(',')
      ->check(CLI::IsMember({"detector", "pose", "mapper"}));
  app.add_option("--start-timeout", options.start_timeout_s,
                 "lockstep: max time to wait for these processes at the start [60]")
      ->option_text("SECONDS")
      ->check(CLI::Range(1, 86400));
  app.add_option(
         "--wait-for", options.process.wait_for,
         "with --speed: start when these processes are running, such as detector,pose,mapper")
      ->option_text("NAMES")
      ->delimiter(',')
      ->needs(speed);
  app.add_flag("--hold", options.process.hold, "with --speed: keep running after the last message")
      ->needs(speed);
  bus::add_common_options(app, common);
  try {
    app.parse(argc, argv);
    if (options.log_path.empty() && !common.print_config) throw CLI::RequiredError("LOG");
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error) == 0 ? bus::kExitOk : bus::kExitRuntime;
    std::cerr << kName << ": " << error.what() << "; see " << kName << " --help\n";
    return bus::kExitUsage;
  }
  bus::set_up_log(kName, common.log_level);
  options.mode = lockstep             ? PlayerMode::kLockstep
                 : speed->count() > 0 ? PlayerMode::kPaced
                                      : PlayerMode::kInProcess;
  for (std::string& name : options.process.wait_for) {
    name = bus::full_process_name(name);
  }
  if (options.mode == PlayerMode::kInProcess && !options.log_path.empty()) {
    if (!take_replay_rig(options, config_path)) return bus::kExitInput;
  } else if (!bus::load_config(kName, config_path, options.rig)) {
    return bus::kExitInput;
  }
  bus::choose_url(common, !config_path.empty(), options.rig.lcm());
  if (common.print_config) {
    std::cout << options.rig.print(common.print_all ? io::PrintedKeys::kAll
                                                    : io::PrintedKeys::kUser);
    return bus::kExitOk;
  }
  options.process.config = options.rig.effective();
  return std::nullopt;
}

}  // namespace orchard::procs
