// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "calibration/trunks/probability_learner.hpp"
#include "cli/calibrate/calibrate_probability.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// Fits the probabilities to samples, prints the fit and writes it into the rig of the options;
/// returns the exit code. Throws io::FileError, and then writes nothing.
int write_probability(const CalibrateProbabilityOptions& options, const io::Config& config,
                      const std::vector<calibration::ProbabilitySample>& samples);

}  // namespace orchard::cli
