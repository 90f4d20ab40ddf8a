// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/node/node.hpp"
#include "calibration/trunks/probability_learner.hpp"
#include "cli/calibrate/calibrate.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "mapping/landmark.hpp"
#include "text/number_text.hpp"
#include "vision/appearance_config.hpp"

namespace orchard::cli {

/// Replays a log through `nodes`, which are flushed at its end, with a progress bar unless `quiet`.
/// Prints its warnings, prefixed by `command`, except those already in `said`. Throws
/// io::FileError.
void replay_log(const char* command, const std::string& path, const std::vector<bus::Node*>& nodes,
                bool quiet, std::set<std::string>& said);

/// Runs a computation on `input`, which an error of it then names: io::FileError.
template <class Function>
auto naming(const std::string& input, const Function& compute) {
  try {
    return compute();
  } catch (const io::FileError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw io::FileError(input + ": " + error.what());
  }
}

/// The logs of a calibration for its note: "drive.lcm and 2 more".
std::string logs_text(const std::vector<std::string>& log_paths);

/// Writes values with a note of their source (`command`) into a rig: `out_path`, or in place if it
/// is empty; a new rig for an empty `config_path`. Prints the path unless `quiet`.
/// Throws io::FileError and io::ConfigError, and then leaves every file unchanged.
void write_rig(const std::string& config_path, const std::string& out_path,
               const std::vector<io::ConfigValue>& values, const char* command,
               const std::string& note, bool quiet);

/// Parses the --ids of landmarks of a map, such as "4,8,10-12", in ascending order; `map_path` is
/// named in messages. Throws io::FileError for anything else, and naming all ids that the map has
/// not.
std::vector<int> picked_ids(const std::string& text,
                            const std::vector<mapping::Landmark>& landmarks,
                            const std::string& map_path);

/// The YAML values that make a rig use a learnt appearance model: colour_model and all of
/// detector.appearance. Numbers are rounded to six digits, which changes no confidence by more than
/// 1e-4.
std::vector<io::ConfigValue> appearance_values(const vision::AppearanceConfig& config);

/// The YAML values of learnt probabilities: detector.probability, and what mapper.evidence:
/// probability needs.
std::vector<io::ConfigValue> probability_values(const calibration::ProbabilityFit& fit);

}  // namespace orchard::cli
