// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/trunks/probability_learner.hpp"
#include "io/config/config_edit.hpp"

namespace orchard::cli {

/// The YAML values of learnt probabilities: detector.probability, and what mapper.evidence:
/// probability needs.
std::vector<io::ConfigValue> probability_values(const calibration::ProbabilityFit& fit);

}  // namespace orchard::cli
