// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibration/trunks/appearance_learner.hpp"
#include "calibration/trunks/trunk_model.hpp"

namespace orchard::calibration {

/// Appearance model learnt from a drive, and the hue interval's performance on the same windows.
struct TrunkAppearance {
  AppearanceFit fit;               ///< its area is measured on left-out trunks
  double hue_interval_area = 0.5;  ///< measured on the windows that gave the interval
  /// Numbers (from 1) of objects as wide as a trunk that were not chosen, and that a model learnt
  /// from the rest takes for trunks.
  std::vector<int> likely_trunks;
};

/// Learns the appearance of the model's trunks. Windows between their edges are positives; windows
/// beside them at the same height and on other free-standing objects are negatives. If the trunks
/// were not picked by the user, an object that was not chosen but may be as wide as a trunk is a
/// negative only if a model learnt from the rest rejects it. At most twelve observations of each
/// object are used, evenly spread, so that all have similar weight.
///
/// `observations` are those passed to estimate_trunk_model(), `colour` the configuration they were
/// measured with. Throws std::runtime_error with one sentence for too few windows of a class.
TrunkAppearance learn_trunk_appearance(const std::vector<TrunkObservation>& observations,
                                       const TrunkModel& model, const vision::ColourConfig& colour);

/// The model with the likely trunks added: trunks with a neighbour or few observations, which are
/// not chosen at first. `model` if it was picked by the user, or if no appearance can be learnt.
TrunkModel with_likely_trunks(const std::vector<TrunkObservation>& observations,
                              const TrunkModel& model, TrunkModelOptions options,
                              const vision::ColourConfig& colour);

/// Median colour over the trunks; none without usable pixels.
std::optional<vision::WindowLight> trunk_light(const std::vector<TrunkObservation>& observations,
                                               const TrunkModel& model);

}  // namespace orchard::calibration
