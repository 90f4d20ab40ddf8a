// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/scan_observations.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
using geometry::rotation;
using geometry::transform;

namespace {

/// Max duration of a scan; an observation farther from its scan's stamp is not corrected.
constexpr double kMaxScanS = 1.0;

}  // namespace

std::vector<ScanObservation> scan_observations(const detection::Detections& seen, double speed_mps,
                                               double yaw_rate_radps,
                                               const PriorMapConfig& config) {
  std::vector<ScanObservation> observations;
  observations.reserve(seen.trunks.size());
  const double sd2 = config.observation_sd_m * config.observation_sd_m;
  for (const detection::Detection& trunk : seen.trunks) {
    ScanObservation s;
    s.p_base = {trunk.centre_x_m, trunk.centre_y_m};
    s.covariance << trunk.covariance[0], trunk.covariance[1], trunk.covariance[1],
        trunk.covariance[2];
    const bool sound = s.p_base.allFinite() && s.covariance.allFinite() &&
                       s.covariance(0, 0) >= 0.0 && s.covariance(1, 1) >= 0.0 &&
                       s.covariance.determinant() >= 0.0 && std::isfinite(trunk.width_m);
    if (!sound || s.p_base.norm() > config.observation_range_max_m) continue;
    s.covariance += sd2 * Eigen::Matrix2d::Identity();
    s.width_m = std::max(0.0, trunk.width_m);
    s.width_sd_m = std::isfinite(trunk.width_sd_m) ? std::max(0.0, trunk.width_sd_m) : 1.0;
    const double dt_s = timing::seconds(trunk.utime - seen.utime);
    if (std::abs(dt_s) <= kMaxScanS) {
      const double turn_rad = yaw_rate_radps * dt_s;
      const Eigen::Vector3d T_scan_then(speed_mps * dt_s * std::cos(0.5 * turn_rad),
                                        speed_mps * dt_s * std::sin(0.5 * turn_rad), turn_rad);
      s.p_base = transform(T_scan_then, s.p_base);
      const Eigen::Matrix2d R = rotation(turn_rad);
      s.covariance = R * s.covariance * R.transpose();
    }
    observations.push_back(s);
  }
  return observations;
}

}  // namespace orchard::pose
