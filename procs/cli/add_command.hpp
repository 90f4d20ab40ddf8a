// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace orchard::mapping {
struct MapAlignmentConfig;
}

namespace orchard::cli {

/// The action of the command line; the callback of the given subcommand sets it.
using Run = std::function<int()>;

/// Adds a subcommand to `app`. What the help says of it and of its options stands in help.txt.
CLI::App& add_subcommand(CLI::App& app, const char* name);

/// Adds one that needs a subcommand.
CLI::App& add_group(CLI::App& app, const char* name);

/// Adds --version, which the help shows after the options that were added before.
void add_version(CLI::App& command);

/// Calls `callback` when the command line has the command, before its arguments are read, with
/// their number.
void before_arguments(CLI::App& command, std::function<void(std::size_t)> callback);

/// Calls `callback` if the command line ends with this command, without a subcommand.
void on_command(CLI::App& command, std::function<void()> callback);

/// "orchard log info" for the command `info` of `log`.
std::string title_of(const CLI::App& command);

/// The program that has a command: `orchard`, or a companion.
const char* program_of(const CLI::App& command);

/// Replaces this process by `program` from the same folder, with the same arguments; does not
/// return. Throws io::FileError when it cannot be started, or is this one already.
[[noreturn]] int replace_by_program(const char* program);

/// Runs a command. All programs parse the same command line. A function that is not linked into
/// this program (its declaration is weak) runs in the one that has it, so that the mapping program
/// neither builds nor loads the code of calibration, import and reports.
template <class Options>
int run_command(const CLI::App& command, int (*function)(const Options&), const Options& options) {
  return function ? function(options) : replace_by_program(program_of(command));
}

/// Adds a subcommand with the options that `declare` adds, if the command line has it: dozens of
/// commands have hundreds. They live in a closure on the heap, as long as the App that fills them.
template <class Options>
void add_command(CLI::App& app, Run& run, const char* name, int (*function)(const Options&),
                 void (*declare)(CLI::App&, Options&)) {
  const auto options = std::make_shared<Options>();
  CLI::App& command = add_subcommand(app, name);
  before_arguments(command, [&command, options, declare](std::size_t) {
    declare(command, *options);
    add_version(command);
  });
  on_command(command, [&run, &command, options, function] {
    run = [&command, options, function] { return run_command(command, function, *options); };
  });
}

/// Adds an option, or an argument where `name` has no dashes, whose help names its values `type`.
template <class Value>
CLI::Option* add_value(CLI::App& command, const char* name, Value& value, const char* type);

/// The same, without which the command is refused.
template <class Value>
CLI::Option* add_required(CLI::App& command, const char* name, Value& value, const char* type);

/// Adds an option whose help shows its default.
template <class Value>
CLI::Option* add_shown(CLI::App& command, const char* name, Value& value);

/// The same for a value that passes a check, which the help shows, too.
template <class Value>
CLI::Option* add_checked(CLI::App& command, const char* name, Value& value,
                         const CLI::Validator& check);

/// The same for a number in [lo, hi].
template <class Value>
CLI::Option* add_limited(CLI::App& command, const char* name, Value& value, Value lo, Value hi);

/// Adds all commands of `orchard`, in the order of its help.
void add_all_commands(CLI::App& app, Run& run);

// Its groups in separate files.
void add_calibrate(CLI::App& app, Run& run);
void add_farm(CLI::App& app, Run& run);
void add_map_commands(CLI::App& app, Run& run);

/// Adds the options of map registration.
void add_alignment_options(CLI::App& command, mapping::MapAlignmentConfig& config);

}  // namespace orchard::cli
