// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/trunks/trunk_model.hpp"
#include "calibration/trunks/trunk_observation.hpp"

namespace orchard::calibration {

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
