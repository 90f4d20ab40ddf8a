// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/process_options.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

namespace orchard::bus {
namespace {

constexpr const char* kFooter =
    "Exit codes: 0 stopped (Ctrl-C, SIGTERM) or end of input, 1 runtime failure,\n"
    "2 bad command line, 3 bad configuration or input file.";

}  // namespace

void add_network_options(CLI::App& app, NetworkOptions& options) {
  app.add_option(
         "--lcm-url", options.lcm_url,
         "URL of the LCM network [that of the rig, else $LCM_DEFAULT_URL, else the default]")
      ->option_text("URL");
  const auto check_name = [](const std::string& name) -> std::string {
    return is_robot_name(name) ? "" : name + ": must be 1 to 32 letters, digits, - or _";
  };
  app.add_option("--robot", options.robot,
                 "name of the robot, on a network of several: its channels are NAME/SCAN and so on "
                 "[robot=NAME of the URL, else none]")
      ->option_text("NAME")
      ->check(check_name);
}

void add_common_options(CLI::App& app, CommonOptions& options) {
  add_network_options(app, options);
  app.add_option(
         "--log-level", options.log_level,
         "lowest level of log lines to print: trace, debug, info, warning, error or off [info]")
      ->option_text("LEVEL")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}));
  auto* print_flag =
      app.add_flag("--print-config", options.print_config,
                   "print the effective configuration with units and ranges, and exit");
  app.add_flag("--all", options.print_all, "with --print-config: also print the expert keys")
      ->needs(print_flag);
}

void set_up_log(const std::string& program, const std::string& level) {
  auto logger = spdlog::get(program);
  if (!logger) logger = spdlog::stderr_color_mt(program);
  logger->set_pattern("%H:%M:%S.%e %n %^%l%$: %v");
  spdlog::set_default_logger(logger);
  spdlog::set_level(spdlog::level::from_str(level == "warning" ? "warn" : level));
}

std::string full_process_name(const std::string& name) {
  return name.rfind("orchard-", 0) == 0 ? name : "orchard-" + name;
}

const char* choose_url(const NetworkOptions& given, bool has_rig, io::LcmConfig& lcm) {
  const char* environment = std::getenv("LCM_DEFAULT_URL");
  const char* why = "the default";
  if (!given.lcm_url.empty()) {
    lcm.url = given.lcm_url;
    why = "--lcm-url";
  } else if (has_rig) {
    why = "the rig";
  } else if (environment != nullptr && environment[0] != '\0') {
    lcm.url = environment;
    why = "LCM_DEFAULT_URL";
  }
  lcm.url = with_robot(lcm.url, given.robot);
  spdlog::debug("LCM: {} ({})", lcm.url, why);
  return why;
}

std::string_view version() { return ORCHARD_VERSION; }

bool load_config(const std::string& program, const std::string& path, io::ConfigFile& config) {
  if (path.empty()) return true;
  try {
    config.load(path);
    return true;
  } catch (const io::ConfigError& error) {
    for (const std::string& problem : error.problems()) std::cerr << problem << "\n";
    std::cerr << program << ": " << error.problems().size() << " error(s) in the configuration\n";
    return false;
  }
}

std::optional<int> read_options(int argc, char** argv, const ProcessInfo& info, ProcessKind kind,
                                io::ConfigFile& config, ProcessOptions& options) {
  CLI::App app(info.description, info.name);
  app.footer(kFooter);
  app.set_version_flag("-V,--version", info.name + " " + std::string(version()));
  std::string config_path;
  CommonOptions common;
  app.add_option("--config", config_path,
                 info.load_default ? "configuration of the rig [that of the scene]"
                                   : "configuration of the rig [built-in defaults]")
      ->option_text("FILE");
  add_common_options(app, common);
  if (kind == ProcessKind::kNode) {
    app.add_flag("--lockstep", options.lockstep,
                 "run in a replay of orchard-log-player --lockstep instead of live; ready for the "
                 "next replay until stopped");
  } else if (kind == ProcessKind::kDriver) {
    app.add_option("--speed", options.speed,
                   "speed as a multiple of real time; too high a speed loses messages [1]")
        ->option_text("FACTOR")
        ->check(CLI::Range(1e-3, 1e3));
    app.add_option("--wait-for", options.wait_for,
                   "start when these processes are running, such as detector,pose,mapper")
        ->option_text("NAMES")
        ->delimiter(',');
    app.add_flag("--hold", options.hold, "keep running after the last message until stopped");
  }
  for (const ExtraOption& option : info.options) {
    if (option.value_name.empty()) {
      app.add_flag_callback(
          option.flag, [value = option.value] { *value = "true"; }, option.help);
    } else {
      app.add_option(option.flag, *option.value, option.help)->option_text(option.value_name);
    }
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error) == 0 ? kExitOk : kExitRuntime;
    std::cerr << info.name << ": " << error.what() << "; see " << info.name << " --help\n";
    return kExitUsage;
  }
  for (std::string& name : options.wait_for) name = full_process_name(name);
  set_up_log(info.name, common.log_level);
  if (config_path.empty() && info.load_default) {
    info.load_default();
  } else if (!load_config(info.name, config_path, config)) {
    return kExitInput;
  }
  choose_url(common, !config_path.empty(), config.lcm());
  if (common.print_config) {
    std::cout << config.print(common.print_all ? io::PrintedKeys::kAll : io::PrintedKeys::kUser);
    return kExitOk;
  }
  if (info.lockstep != nullptr) *info.lockstep = options.lockstep;
  options.config = config.effective();
  if (config_path.empty() && !info.load_default) {
    spdlog::warn(
        "no --config given: using the built-in defaults; give the configuration of the robot");
  }
  return std::nullopt;
}

}  // namespace orchard::bus
