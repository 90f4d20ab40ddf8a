// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/trunks/trunk_model.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::cli {

/// The decision written by `calibrate trunks`.
enum class DecisionChoice {
  kAuto,         ///< the one with fewer errors on objects left out of the fit
  kRoc,          ///< the paper's
  kProbability,  ///< weights of width and camera learnt from the drive
};

/// The drives of a trunk model: one log and one path each.
struct TrunkDrives {
  std::vector<std::string> log_paths;
  std::vector<std::vector<pose::PoseEstimate>> paths;  ///< T_map_base over time
  std::vector<calibration::TrunkObservation> observations;
};

/// Learns how much width and camera say in these drives (detector.probability), from the detections
/// at the model's trunks and other objects by the rig `learnt`, which already has their width and
/// colour. The colour model has seen all of these objects; what is left out is left out of the
/// weights alone. Returns the weights and the decision chosen, and adds a sentence to `note`; none
/// if there are too few detections and `choice` is kAuto; with kRoc the decision alone. Throws
/// io::FileError if kProbability cannot be learnt.
std::vector<io::ConfigValue> learn_decision(const TrunkDrives& drives,
                                            const calibration::TrunkModel& model, io::Config learnt,
                                            DecisionChoice choice, bool quiet, std::string& note);

}  // namespace orchard::cli
