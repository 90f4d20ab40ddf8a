// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "detection/detect.hpp"
#include "detection/rig.hpp"

namespace orchard::calibration {

/// A trunk in an image: the offsets of its possible edges, and the rate at which its column moves.
struct DelayObservation {
  std::int32_t picture = 0;        ///< index of the image; its observations share errors
  double rate_px_per_s = 0.0;      ///< rate of the expected column, by odometry
  double yaw_rate_radps = 0.0;     ///< of base
  std::vector<double> offsets_px;  ///< found minus expected column; at most one is the trunk
};

/// Extracts the observations from a scan and its image, with the present delay of `rig`.
std::vector<DelayObservation> delay_observations(const detection::LaserFindings& findings,
                                                 const vision::Image& image,
                                                 const detection::Rig& rig,
                                                 const detection::Motion& motion, double reach_px,
                                                 std::int32_t picture);

struct DelayOptions {
  int min_observations = 40;
  int min_turning_observations = 20;  ///< at a yaw rate of at least turning_radps
  double turning_radps = 0.1;
  double max_se_s = 0.005;  ///< max standard error of an accepted estimate
};

/// Correction of the camera delay.
struct DelayEstimate {
  double delay_s = 0.0;    ///< to be added to the present delay
  double se_s = 0.0;       ///< standard error; errors within one image count as common
  double offset_px = 0.0;  ///< constant offset: rotation of the camera
  double offset_se_px = 0.0;
  double residual_sd_px = 0.0;
  int num_observations = 0;  ///< number of inliers
  int num_all = 0;
  int num_pictures = 0;
  int num_turning = 0;  ///< of num_observations
};

/// Fits offset = b - rate x delay to the observations: a vote finds the pair (delay, b) with most
/// inliers, robust least squares (Tukey's biweight) refines it. Delay and constant offset are
/// separable because the columns move at different rates to both sides.
///
/// Throws std::runtime_error with a message for the user: too few observations, too little turning,
/// too few inliers, or a standard error above max_se_s.
DelayEstimate estimate_delay(const std::vector<DelayObservation>& observations,
                             const DelayOptions& options);

}  // namespace orchard::calibration
