// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "calibration/trunks/appearance_learner.hpp"
#include "calibration/trunks/trunk_model.hpp"
#include "calibration/trunks/trunk_observation.hpp"

namespace orchard::calibration {

/// Appearance model learnt from a drive, and the hue interval's performance on the same windows.
struct TrunkAppearance {
  AppearanceFit fit;               ///< its area is measured on left-out trunks
  double hue_interval_area = 0.5;  ///< measured on the windows that gave the interval
};

/// Learns the appearance of the model's trunks. Windows between their edges are positives; windows
/// beside them at the same height and on other free-standing objects are negatives. Doubtful
/// objects are left out. At most twelve observations of each object are used, evenly spread, so
/// that all have similar weight.
///
/// `observations` are those passed to estimate_trunk_model(), `colour` the configuration they were
/// measured with. Throws std::runtime_error with one sentence for too few windows of a class.
TrunkAppearance learn_trunk_appearance(const std::vector<TrunkObservation>& observations,
                                       const TrunkModel& model, const vision::ColourConfig& colour);

/// Mean log odds of each object's windows that it is a trunk, by an appearance model learnt without
/// the object; empty for an object without windows. Throws std::runtime_error as
/// learn_trunk_appearance() does.
std::vector<std::optional<double>> trunk_scores(const std::vector<TrunkObservation>& observations,
                                                const TrunkModel& model);

/// Judges the model's objects by the camera when nobody said which of them are trunks, and returns
/// the model of those that look like trunks.
///
/// The trunks of `model` were chosen by width, so a post as wide as they are is among them, and a
/// trunk with a neighbour or with few observations is not. Each object within reach of their widths
/// that does not move is judged by an appearance model that was learnt without it. The model is
/// learnt again from the objects that look like trunks until none is added; one that may be either
/// is doubtful. Trunks are rejected in the first round alone, since a model learnt from ever fewer
/// trunks would reject ever more.
///
/// `model` if it was picked by the user, or if no appearance can be learnt. `options` are those of
/// estimate_trunk_model().
TrunkModel select_trunks(const std::vector<TrunkObservation>& observations, const TrunkModel& model,
                         const TrunkModelOptions& options);

}  // namespace orchard::calibration
