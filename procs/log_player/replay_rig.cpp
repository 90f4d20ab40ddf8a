// SPDX-License-Identifier: BSD-3-Clause
#include "log_player/replay_rig.hpp"

#include <utility>

#include "bus/replay/logged_rig.hpp"
#include "io/config/config_difference.hpp"

namespace orchard::procs {
namespace {

/// The logged rig, with this release's defaults for keys that an older release did not have.
std::string completed(const bus::LoggedRig& rig) {
  try {
    return io::effective_config(io::parse_recorded_config(rig.yaml, "").config);
  } catch (const io::ConfigError&) {
    return rig.yaml;  // has a value that this release refuses: compare verbatim
  }
}

}  // namespace

ReplayRig choose_rig(const io::LogPaths& logs, const std::string& config_path) {
  if (config_path.empty()) {
    const bus::LoggedRig rig = bus::rig_of_log(logs);
    const std::string file = logs.names();
    const std::string name = "the rig in " + file;
    try {
      io::RecordedConfig recorded = io::parse_recorded_config(rig.yaml, name);
      for (std::string& note : recorded.notes) note = name + ": " + note;
      return {std::move(recorded.config), name, std::move(recorded.notes)};
    } catch (const io::ConfigError& error) {
      std::vector<std::string> problems = error.problems();
      problems.push_back(
          file + " was recorded by version " + rig.version +
          ", whose configuration this version cannot read; give the rig with --config FILE");
      throw io::ConfigError(std::move(problems));
    }
  }
  ReplayRig chosen{io::load_config(config_path), config_path, {}};
  const std::string given = io::effective_config(chosen.config);
  std::vector<io::ConfigDifference> of_first;  // the first rig of the log is compared
  for (const bus::LoggedRig& rig : bus::read_logged_rigs(logs)) {
    auto differences = io::config_differences(completed(rig), given);
    if (differences.empty()) return chosen;
    if (of_first.empty()) of_first = std::move(differences);
  }
  if (of_first.empty()) return chosen;
  chosen.notes.push_back(config_path + " differs from the configuration that " + logs.text() +
                         " was recorded with (key: in the log -> given):");
  for (const std::string& line : io::difference_lines(of_first)) {
    chosen.notes.push_back("  " + line);
  }
  return chosen;
}

}  // namespace orchard::procs
