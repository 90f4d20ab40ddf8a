// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/corrections/correction.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// The landmarks by which a new map's ids are kept when the earlier one was corrected: all that the
/// earlier run mapped, and after them what people added, by `corrected` of it. So a tree that was
/// missed and is seen now gets the id that people know.
std::vector<Landmark> known_landmarks(const std::vector<Landmark>& earlier,
                                      const std::vector<Landmark>& corrected);

/// Corrections of an earlier map as they are of a new one of the same orchard, whose ids are kept
/// (keep_ids()) and whose frame is laid on the earlier one by `T_earlier_now`.
///
/// Places go through the alignment and then with the known landmarks around them: two drives'
/// maps are a little bent against each other.
std::vector<Correction> carry_corrections(const std::vector<Correction>& corrections,
                                          const std::vector<Landmark>& earlier,
                                          const std::vector<Landmark>& now,
                                          const geometry::Pose2& T_earlier_now);

}  // namespace orchard::mapping
