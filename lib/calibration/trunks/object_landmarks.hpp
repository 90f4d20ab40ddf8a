// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/trunks/trunk_model.hpp"
#include "mapping/landmark.hpp"

namespace orchard::calibration {

/// The objects of one log as landmarks in map: tree, object, or unseen for a doubtful one. Standard
/// errors are those of the mean of the object's observations. Objects without poses are left out.
std::vector<mapping::Landmark> object_landmarks(const TrunkModel& model,
                                                const std::vector<TrunkObservation>& observations,
                                                int log);

}  // namespace orchard::calibration
