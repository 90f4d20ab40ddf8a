// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibration/trunks/appearance_learner.hpp"
#include "calibration/trunks/trunk_model.hpp"

namespace orchard::calibration {

/// What a drive teaches of the trunks' appearance, beside the hue interval on the same windows.
struct TrunkAppearance {
  AppearanceFit fit;               ///< its area is that of trunks left out of the fit
  double hue_interval_area = 0.5;  ///< of the windows that the interval was taken from
};

/// Learns the appearance of the model's trunks. Windows between their edges are positives;
/// windows beside them at the same height, and windows on everything else that stands alone, are
/// negatives. Where nobody picked the trunks, what is as wide as they are may be one in another
/// light: it teaches only if what the rest teaches takes it for none. At most a dozen looks at each
/// thing, spread evenly, so that none weighs too much.
///
/// `observations` are those of estimate_trunk_model, `colour` what they were measured with. Throws
/// std::runtime_error with one sentence when there are too few windows of a kind.
TrunkAppearance learn_trunk_appearance(const std::vector<TrunkObservation>& observations,
                                       const TrunkModel& model, const vision::ColourConfig& colour);

/// The trunks' colour on the whole: the median over trunks, or none without usable pixels.
std::optional<vision::WindowLight> trunk_light(const std::vector<TrunkObservation>& observations,
                                               const TrunkModel& model);

}  // namespace orchard::calibration
