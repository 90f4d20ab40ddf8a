// SPDX-License-Identifier: BSD-3-Clause
#include "log_player/replay_rig.hpp"

#include <string_view>
#include <utility>
#include <vector>

#include "bus/node/process_options.hpp"
#include "bus/replay/logged_rig.hpp"
#include "io/config/config_difference.hpp"

namespace orchard::procs {
namespace {

/// Numbers of a version such as "0.2.0".
std::vector<int> numbers_of(std::string_view version) {
  std::vector<int> numbers{0};
  for (const char c : version) {
    if (c == '.') numbers.push_back(0);
    if (c >= '0' && c <= '9' && numbers.back() < 100'000) {
      numbers.back() = 10 * numbers.back() + (c - '0');
    }
  }
  return numbers;
}

/// Reads a logged rig. Keys that this release no longer has are noted; those of a newer release are
/// errors, because what they mean is unknown.
io::RecordedConfig parse(const bus::LoggedRig& rig, const std::string& name) {
  const bool is_newer = numbers_of(rig.version) > numbers_of(bus::version());
  if (is_newer) return {io::parse_config(rig.yaml, name), {}};
  return io::parse_recorded_config(rig.yaml, name);
}

/// The logged rig, with this release's defaults for keys that an older release did not have.
std::string completed(const bus::LoggedRig& rig) {
  try {
    return io::effective_config(parse(rig, "").config);
  } catch (const io::ConfigError&) {
    return rig.yaml;  // has a key or value that this release refuses: compare verbatim
  }
}

}  // namespace

ReplayRig choose_rig(const io::LogPaths& logs, const std::string& config_path) {
  if (config_path.empty()) {
    const bus::LoggedRig rig = bus::rig_of_log(logs);
    const std::string file = logs.names();
    const std::string name = "the rig in " + file;
    try {
      io::RecordedConfig recorded = parse(rig, name);
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
    if (rig.yaml == given) return chosen;  // as of a log of this release: reading it takes a while
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
