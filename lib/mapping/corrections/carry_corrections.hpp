// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/corrections/correction.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Landmarks used to keep ids when the earlier map was corrected: all landmarks of the earlier run,
/// then those added by people (from `corrected`). A tree that was missed earlier and is seen now
/// thus gets the id that people gave it.
std::vector<Landmark> known_landmarks(const std::vector<Landmark>& earlier,
                                      const std::vector<Landmark>& corrected);

/// Converts corrections of an earlier map for a new map of the same orchard, whose ids are kept
/// (keep_ids()) and which is aligned to the earlier one by `T_earlier_now`.
///
/// Positions are transformed by the alignment plus the local deformation of the known landmarks
/// around them.
std::vector<Correction> carry_corrections(const std::vector<Correction>& corrections,
                                          const std::vector<Landmark>& earlier,
                                          const std::vector<Landmark>& now,
                                          const geometry::Pose2& T_earlier_now);

}  // namespace orchard::mapping
