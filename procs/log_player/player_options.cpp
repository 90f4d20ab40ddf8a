// SPDX-License-Identifier: BSD-3-Clause
#include "log_player/player_options.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <utility>

#include "io/file_error.hpp"
#include "log_player/replay_rig.hpp"

namespace orchard::procs {
namespace {

constexpr const char* kName = "orchard-log-player";

constexpr const char* kDescription =
    "Replays the source channels of an LCM log (SCAN, IMAGE, ODOMETRY, GNSS, POSE_FIX).\n"
    "\n"
    "--in-process (default): detector, pose and mapper inside this program; fast, deterministic.\n"
    "--lockstep: the real processes, each started with --lockstep on the same LCM URL; every\n"
    "  message waits until the last one's consequences are acknowledged; deterministic.\n"
    "--speed X: paced by the clock, for people and lcm-spy; messages may be lost, and the result\n"
    "  is not deterministic.";

constexpr const char* kFooter =
    "Exit codes: 0 replayed (and equal, with --verify), 1 runtime failure, a silent node or a\n"
    "difference, 2 bad command line, 3 bad configuration or log.";

void set_up_log(const std::string& level) {
  auto logger = spdlog::stderr_color_mt(kName);
  logger->set_pattern("%H:%M:%S.%e %n %^%l%$: %v");
  spdlog::set_default_logger(logger);
  spdlog::set_level(spdlog::level::from_str(level == "warning" ? "warn" : level));
}

/// Chooses the rig of the replay and prints its notes; false on failure.
bool take_replay_rig(PlayerOptions& options, const std::string& config_path) {
  try {
    ReplayRig rig = choose_rig(options.log_path, config_path);
    for (const std::string& note : rig.notes) spdlog::warn("{}", note);
    options.rig = io::RigFile(std::move(rig.config));
    return true;
  } catch (const io::ConfigError& error) {
    for (const std::string& problem : error.problems()) std::cerr << problem << "\n";
    std::cerr << kName << ": " << error.problems().size() << " mistake(s) in the configuration\n";
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
  std::string lcm_url;
  std::string log_level = "info";
  bool print_config = false;
  bool print_all = false;
  bool in_process = false;
  bool lockstep = false;
  app.add_option("log", options.log_path, "the log (lcm-logger's format)")->option_text("LOG");
  auto* in_process_flag = app.add_flag("--in-process", in_process, "the default mode");
  auto* lockstep_flag = app.add_flag("--lockstep", lockstep, "through processes that take turns");
  auto* speed = app.add_option("--speed", options.process.speed, "times real time")
                    ->option_text("FACTOR")
                    ->check(CLI::Range(1e-3, 1e3));
  lockstep_flag->excludes(in_process_flag)->excludes(speed);
  speed->excludes(in_process_flag);
  app.add_option("--config", config_path, "the rig's YAML (without: the rig in LOG)")
      ->option_text("FILE");
  app.add_option("--out", options.out_path, "write every derived message to this log")
      ->option_text("FILE")
      ->excludes(speed);
  app.add_flag("--verify", options.verify,
               "compare the derived messages, byte by byte, with those recorded in LOG")
      ->excludes(speed);
  app.add_flag("--strict", options.replay.strict, "refuse a log with any damage or bad message");
  app.add_option("--from", options.replay.from_s, "begin this many seconds into the log")
      ->option_text("SECONDS");
  app.add_option("--to", options.replay.to_s, "end this many seconds into the log")
      ->option_text("SECONDS");
  app.add_option("--nodes", options.nodes, "lockstep: who takes part (detector,pose,mapper)")
      ->option_text("NAMES")
      ->delimiter(',')
      ->check(CLI::IsMember({"detector", "pose", "mapper"}));
  app.add_option("--start-timeout", options.start_timeout_s,
                 "lockstep: how long to wait for them to appear (60)")
      ->option_text("SECONDS")
      ->check(CLI::Range(1, 86400));
  app.add_option("--wait-for", options.process.wait_for,
                 "paced: begin when these were heard on STATUS, such as detector,pose,mapper")
      ->option_text("NAMES")
      ->delimiter(',')
      ->needs(speed);
  app.add_flag("--hold", options.process.hold, "paced: stay after the last message")->needs(speed);
  app.add_option("--lcm-url", lcm_url,
                 "LCM network (without: the rig's, then $LCM_DEFAULT_URL, then the default)")
      ->option_text("URL");
  app.add_option("--log-level", log_level, "trace, debug, info, warning, error or off")
      ->option_text("LEVEL")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}));
  auto* print_flag =
      app.add_flag("--print-config", print_config, "print the effective configuration, and exit");
  app.add_flag("--all", print_all, "with --print-config: the keys for experts, too")
      ->needs(print_flag);
  try {
    app.parse(argc, argv);
    if (options.log_path.empty() && !print_config) throw CLI::RequiredError("LOG");
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error) == 0 ? bus::kExitOk : bus::kExitRuntime;
    std::cerr << kName << ": " << error.what() << "; see " << kName << " --help\n";
    return bus::kExitUsage;
  }
  set_up_log(log_level);
  options.mode = lockstep             ? PlayerMode::kLockstep
                 : speed->count() > 0 ? PlayerMode::kPaced
                                      : PlayerMode::kInProcess;
  for (std::string& name : options.process.wait_for) {
    if (name.rfind("orchard-", 0) != 0) name = "orchard-" + name;
  }
  if (options.mode == PlayerMode::kInProcess && !options.log_path.empty()) {
    if (!take_replay_rig(options, config_path)) return bus::kExitInput;
  } else if (!bus::load_config(kName, config_path, options.rig)) {
    return bus::kExitInput;
  }
  bus::choose_url(lcm_url, !config_path.empty(), options.rig.lcm());
  if (print_config) {
    std::cout << options.rig.print(print_all ? io::PrintedKeys::kAll : io::PrintedKeys::kUser);
    return bus::kExitOk;
  }
  options.process.config = options.rig.effective();
  return std::nullopt;
}

}  // namespace orchard::procs
