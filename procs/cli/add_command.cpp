// SPDX-License-Identifier: BSD-3-Clause
#include "cli/add_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <utility>
#include <vector>

namespace orchard::cli {

CLI::App& add_subcommand(CLI::App& app, const char* name, const char* description,
                         const char* examples) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer(std::string("Examples:\n") + examples);
  return *command;
}

void on_command(CLI::App& command, std::function<void()> callback) {
  // CLI11 calls a command's callback after those of its subcommands.
  command.callback([&command, callback = std::move(callback)] {
    if (command.get_subcommands().empty()) callback();
  });
}

template <class Value>
CLI::Option* add_value(CLI::App& command, const char* name, Value& value, const char* type,
                       const char* description) {
  return command.add_option(name, value, description)->type_name(type);
}

template <class Value>
CLI::Option* add_required(CLI::App& command, const char* name, Value& value, const char* type,
                          const char* description) {
  return add_value(command, name, value, type, description)->required();
}

template <class Value>
CLI::Option* add_limited(CLI::App& command, const char* name, Value& value, Value lo, Value hi,
                         const char* description) {
  return command.add_option(name, value, description)
      ->check(CLI::Range(lo, hi))
      ->capture_default_str();
}

#define ORCHARD_OPTION_OF(Value)                                                             \
  template CLI::Option* add_value(CLI::App&, const char*, Value&, const char*, const char*); \
  template CLI::Option* add_required(CLI::App&, const char*, Value&, const char*, const char*);
#define ORCHARD_NUMBER_OF(Value) \
  ORCHARD_OPTION_OF(Value)       \
  template CLI::Option* add_limited(CLI::App&, const char*, Value&, Value, Value, const char*);
ORCHARD_OPTION_OF(std::string)
ORCHARD_OPTION_OF(std::vector<std::string>)
ORCHARD_OPTION_OF(std::vector<double>)
ORCHARD_OPTION_OF(std::int64_t)
ORCHARD_NUMBER_OF(double)
ORCHARD_NUMBER_OF(int)

}  // namespace orchard::cli
