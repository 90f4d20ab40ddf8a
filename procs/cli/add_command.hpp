// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace orchard::mapping {
struct MapAlignmentConfig;
}

namespace orchard::cli {

/// The action of the command line; the callback of the given subcommand sets it.
using Run = std::function<int()>;

/// Adds a subcommand to `app`, with examples under its help.
CLI::App& add_subcommand(CLI::App& app, const char* name, const char* description,
                         const char* examples);

/// Calls `callback` if the command line ends with this command, without a subcommand.
void on_command(CLI::App& command, std::function<void()> callback);

/// Adds a subcommand with its options. The options live in a closure on the heap, as long as the
/// App that fills them.
template <class Options>
CLI::App& add_command(CLI::App& app, Run& run, const char* name, const char* description,
                      const char* examples, int (*function)(const Options&),
                      const std::function<void(CLI::App&, Options&)>& add_options) {
  const auto options = std::make_shared<Options>();
  CLI::App& command = add_subcommand(app, name, description, examples);
  add_options(command, *options);
  on_command(command, [&run, options, function] {
    run = [options, function] { return function(*options); };
  });
  return command;
}

/// Adds an option, or an argument where `name` has no dashes, whose help names its values `type`.
template <class Value>
CLI::Option* add_value(CLI::App& command, const char* name, Value& value, const char* type,
                       const char* description);

/// The same, without which the command is refused.
template <class Value>
CLI::Option* add_required(CLI::App& command, const char* name, Value& value, const char* type,
                          const char* description);

/// Adds an option for a number in [lo, hi], whose help names limits and default.
template <class Value>
CLI::Option* add_limited(CLI::App& command, const char* name, Value& value, Value lo, Value hi,
                         const char* description);

// Functions that add the command groups defined in separate files.
void add_calibrate(CLI::App& app, Run& run);
void add_calibrate_laser_camera(CLI::App& calibrate, Run& run);
void add_compare(CLI::App& app, Run& run);
void add_evaluate(CLI::App& app, Run& run);
void add_export(CLI::App& app, Run& run);
void add_farm(CLI::App& app, Run& run);
void add_field(CLI::App& app, Run& run);
void add_growers(CLI::App& app, Run& run);
void add_import_edits(CLI::App& app, Run& run);
void add_merge(CLI::App& app, Run& run);
void add_plan(CLI::App& app, Run& run);
void add_publish(CLI::App& app, Run& run);
void add_report(CLI::App& app, Run& run);
void add_view(CLI::App& app, Run& run);

/// Adds the options of map registration.
void add_alignment_options(CLI::App& command, mapping::MapAlignmentConfig& config);

}  // namespace orchard::cli
