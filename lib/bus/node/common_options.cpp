// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/common_options.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

namespace orchard::bus {

void add_common_options(CLI::App& app, CommonOptions& options) {
  app.add_option(
         "--lcm-url", options.lcm_url,
         "URL of the LCM network [that of the rig, else $LCM_DEFAULT_URL, else the default]")
      ->option_text("URL");
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

}  // namespace orchard::bus
