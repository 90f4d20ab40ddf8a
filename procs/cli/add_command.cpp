// SPDX-License-Identifier: BSD-3-Clause
#include "cli/add_command.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <utility>
#include <vector>

namespace orchard::cli {

CLI::App& add_subcommand(CLI::App& app, const char* name) {
  return *app.add_subcommand(name)->group("Commands");
}

CLI::App& add_group(CLI::App& app, const char* name) {
  CLI::App& command = add_subcommand(app, name);
  add_version(command);
  return *command.require_subcommand(1);
}

void add_version(CLI::App& command) {
  command.set_version_flag("-V,--version", "orchard " ORCHARD_VERSION,
                           "print the version and exit");
}

void before_arguments(CLI::App& command, std::function<void(std::size_t)> callback) {
  command.preparse_callback(std::move(callback));
}

void on_command(CLI::App& command, std::function<void()> callback) {
  // CLI11 calls a command's callback after those of its subcommands.
  command.callback([&command, callback = std::move(callback)] {
    if (command.get_subcommands().empty()) callback();
  });
}

template <class Value>
CLI::Option* add_value(CLI::App& command, const char* name, Value& value, const char* type) {
  return command.add_option(name, value)->type_name(type);
}

template <class Value>
CLI::Option* add_required(CLI::App& command, const char* name, Value& value, const char* type) {
  return add_value(command, name, value, type)->required();
}

template <class Value>
CLI::Option* add_shown(CLI::App& command, const char* name, Value& value) {
  return command.add_option(name, value)->capture_default_str();
}

template <class Value>
CLI::Option* add_checked(CLI::App& command, const char* name, Value& value,
                         const CLI::Validator& check) {
  return add_shown(command, name, value)->check(check);
}

template <class Value>
CLI::Option* add_limited(CLI::App& command, const char* name, Value& value, Value lo, Value hi) {
  return add_checked(command, name, value, CLI::Range(lo, hi));
}

#define ORCHARD_OPTION_OF(Value)                                                   \
  template CLI::Option* add_value(CLI::App&, const char*, Value&, const char*);    \
  template CLI::Option* add_required(CLI::App&, const char*, Value&, const char*); \
  template CLI::Option* add_shown(CLI::App&, const char*, Value&);                 \
  template CLI::Option* add_checked(CLI::App&, const char*, Value&, const CLI::Validator&);
#define ORCHARD_NUMBER_OF(Value) \
  ORCHARD_OPTION_OF(Value)       \
  template CLI::Option* add_limited(CLI::App&, const char*, Value&, Value, Value);
ORCHARD_OPTION_OF(std::string)
ORCHARD_OPTION_OF(std::vector<std::string>)
ORCHARD_OPTION_OF(std::vector<double>)
ORCHARD_OPTION_OF(std::int64_t)
ORCHARD_OPTION_OF(std::uint64_t)
ORCHARD_NUMBER_OF(double)
ORCHARD_NUMBER_OF(int)

}  // namespace orchard::cli
