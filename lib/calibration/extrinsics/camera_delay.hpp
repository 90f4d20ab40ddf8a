// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "detection/edge_offset.hpp"

namespace orchard::calibration {

/// A trunk in a picture: where its edges may stand, and how fast its column moves.
struct DelayObservation {
  std::int32_t picture = 0;        ///< looks at one picture share its errors
  double rate_px_per_s = 0.0;      ///< of the column that the laser expects, by odometry
  double yaw_rate_radps = 0.0;     ///< of base
  std::vector<double> offsets_px;  ///< found minus expected column; of these one is the trunk
};

/// The observations that a scan and its picture give, with the delay that `rig` believes in.
std::vector<DelayObservation> look_at_delay(const detection::LaserFindings& findings,
                                            const vision::Image& image, const detection::Rig& rig,
                                            const detection::Motion& motion, double reach_px,
                                            std::int32_t picture);

struct DelayOptions {
  int min_observations = 40;
  int min_turning_observations = 20;  ///< at a yaw rate of at least turning_radps
  double turning_radps = 0.1;
  double max_se_s = 0.005;  ///< an estimate less certain than this is refused
};

/// How much later the camera's pictures are than the delay that was believed in says.
struct DelayEstimate {
  double delay_s = 0.0;    ///< to be added to that delay
  double se_s = 0.0;       ///< standard error, errors within one picture taken as common
  double offset_px = 0.0;  ///< left over whatever the motion: a camera that is turned
  double offset_se_px = 0.0;
  double residual_sd_px = 0.0;
  int num_observations = 0;  ///< that agree with it
  int num_all = 0;
  int num_pictures = 0;
  int num_turning = 0;  ///< of num_observations
};

/// Fits offset = b - rate x delay to the observations: first the pair (delay, b) that most
/// observations agree with, then robust least squares (Tukey's biweight) from there. The two part
/// because the columns move at many rates, to both sides.
///
/// Throws std::runtime_error with a sentence for a person: too few observations, a robot that
/// hardly turned, observations that agree with no one delay, a standard error above max_se_s.
DelayEstimate estimate_delay(const std::vector<DelayObservation>& observations,
                             const DelayOptions& options);

}  // namespace orchard::calibration
