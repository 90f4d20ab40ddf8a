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
    "Exit codes: 0 stopped (Ctrl-C, SIGTERM) or at the end, 1 runtime failure,\n"
    "2 bad command line, 3 bad configuration or input file.";

/// Log lines go to stderr; stdout is reserved for output that was requested.
void set_up_log(const std::string& name, const std::string& level) {
  auto logger = spdlog::get(name);
  if (!logger) logger = spdlog::stderr_color_mt(name);
  logger->set_pattern("%H:%M:%S.%e %n %^%l%$: %v");
  spdlog::set_default_logger(logger);
  spdlog::set_level(spdlog::level::from_str(level == "warning" ? "warn" : level));
}

std::string full_name(const std::string& name) {
  return name.rfind("orchard-", 0) == 0 ? name : "orchard-" + name;
}

}  // namespace

const char* choose_url(const std::string& lcm_url, bool has_rig, io::LcmConfig& lcm) {
  const char* environment = std::getenv("LCM_DEFAULT_URL");
  const char* why = "the default";
  if (!lcm_url.empty()) {
    lcm.url = lcm_url;
    why = "--lcm-url";
  } else if (has_rig) {
    why = "the rig";
  } else if (environment != nullptr && environment[0] != '\0') {
    lcm.url = environment;
    why = "LCM_DEFAULT_URL";
  }
  spdlog::debug("LCM: {} ({})", lcm.url, why);
  return why;
}

std::string_view version() { return ORCHARD_VERSION; }

bool load_config(const std::string& program, const std::string& path, io::ConfigFile& config) {
  if (path.empty()) return true;
  try {
    for (const std::string& warning : config.load(path)) spdlog::warn("{}", warning);
    return true;
  } catch (const io::ConfigError& error) {
    for (const std::string& problem : error.problems()) std::cerr << problem << "\n";
    std::cerr << program << ": " << error.problems().size() << " mistake(s) in the configuration\n";
    return false;
  }
}

std::optional<int> read_options(int argc, char** argv, const ProcessInfo& info, ProcessKind kind,
                                io::ConfigFile& config, ProcessOptions& options) {
  CLI::App app(info.description, info.name);
  app.footer(kFooter);
  app.set_version_flag("-V,--version", info.name + " " + std::string(version()));
  std::string config_path;
  std::string lcm_url;
  std::string log_level = "info";
  bool print_config = false;
  bool print_all = false;
  app.add_option("--config", config_path,
                 info.load_default ? "the rig's YAML (without: that of the scene)"
                                   : "the rig's YAML (without: built-in defaults)")
      ->option_text("FILE");
  app.add_option("--lcm-url", lcm_url,
                 "LCM network (without: the rig's, then $LCM_DEFAULT_URL, then the default)")
      ->option_text("URL");
  app.add_option("--log-level", log_level, "trace, debug, info, warning, error or off")
      ->option_text("LEVEL")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}));
  auto* print_flag =
      app.add_flag("--print-config", print_config,
                   "print the effective configuration with units and ranges, and exit");
  app.add_flag("--all", print_all, "with --print-config: the keys for experts, too")
      ->needs(print_flag);
  if (kind == ProcessKind::kNode) {
    app.add_flag("--lockstep", options.lockstep,
                 "take turns with orchard-log-player --lockstep instead of running live; stays "
                 "ready for the next replay until stopped");
  } else if (kind == ProcessKind::kDriver) {
    app.add_option("--speed", options.speed,
                   "times real time; above 0, since flat out UDP loses most messages")
        ->option_text("FACTOR")
        ->check(CLI::Range(1e-3, 1e3));
    app.add_option("--wait-for", options.wait_for,
                   "begin when these were heard on STATUS, such as detector,pose,mapper")
        ->option_text("NAMES")
        ->delimiter(',');
    app.add_flag("--hold", options.hold,
                 "stay after the last message until stopped, instead of ending");
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
  for (std::string& name : options.wait_for) name = full_name(name);
  set_up_log(info.name, log_level);
  if (config_path.empty() && info.load_default) {
    info.load_default();
  } else if (!load_config(info.name, config_path, config)) {
    return kExitInput;
  }
  choose_url(lcm_url, !config_path.empty(), config.lcm());
  if (print_config) {
    std::cout << config.print(print_all ? io::PrintedKeys::kAll : io::PrintedKeys::kUser);
    return kExitOk;
  }
  if (info.lockstep != nullptr) *info.lockstep = options.lockstep;
  options.config = config.effective();
  if (config_path.empty() && !info.load_default) {
    spdlog::warn("no --config given: running with built-in defaults");
  }
  return std::nullopt;
}

}  // namespace orchard::bus
