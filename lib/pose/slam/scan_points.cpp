// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/scan_points.hpp"

#include <Eigen/LU>
#include <cmath>

#include "geometry/pose2.hpp"
#include "pose/arc_motion.hpp"

namespace orchard::pose {
using geometry::compose;
using geometry::rotation;
using geometry::transform;

namespace {

/// Standard deviation of a centre, as a fraction of the width: trunks are not round.
constexpr double kObservationSd_widths = 0.1;

/// Additional standard deviation when a nearer object occludes one side, as a fraction of the
/// width.
constexpr double kOccludedSd_widths = 0.25;

/// Additional standard deviation of objects labelled kObject [m]: crates and bushes have no
/// well-defined centre.
constexpr double kObjectSd_m = 0.05;

// Max time between a beam and its scan's stamp; a larger difference is a clock error.
constexpr double kSweepMax_s = 0.5;
constexpr double kWidthSdMin_m = 0.02;
constexpr double kVarianceMin = 1e-6;

bool usable(const detection::Detection& t, const SlamConfig& config) {
  return std::isfinite(t.centre_x_m) && std::isfinite(t.centre_y_m) && std::isfinite(t.width_m) &&
         std::isfinite(t.width_sd_m) && std::isfinite(t.covariance[0]) &&
         std::isfinite(t.covariance[1]) && std::isfinite(t.covariance[2]) &&
         std::hypot(t.centre_x_m, t.centre_y_m) <= config.observation_range_max_m &&
         t.width_m >= 0.0 && t.width_m <= config.width_max_m;
}

double floor_sd_m(const detection::Detection& t, const SlamConfig& config) {
  double sd_m = std::hypot(config.observation_sd_m, kObservationSd_widths * t.width_m);
  if (t.occlusion != 0) sd_m = std::hypot(sd_m, kOccludedSd_widths * t.width_m);
  if (t.label == detection::Label::kObject) sd_m = std::hypot(sd_m, kObjectSd_m);
  return sd_m;
}

}  // namespace

std::vector<ScanPoint> scan_points(const detection::Detections& seen, const ScanMotionState& motion,
                                   const SlamConfig& config) {
  std::vector<ScanPoint> points;
  points.reserve(seen.trunks.size());
  for (const detection::Detection& t : seen.trunks) {
    if (!usable(t, config)) continue;
    double dt_s = (t.utime - seen.utime) * 1e-6;
    if (std::abs(dt_s) > kSweepMax_s) dt_s = 0.0;
    const Eigen::Vector3d T_scan_beam = arc_motion(motion.speed_mps, motion.yaw_rate_radps, dt_s);
    const Eigen::Vector3d T_keyframe_beam = compose(motion.T_keyframe_scan, T_scan_beam);
    const Eigen::Matrix2d R = rotation(T_keyframe_beam.z());
    ScanPoint point;
    point.p_base = transform(T_keyframe_beam, {t.centre_x_m, t.centre_y_m});
    Eigen::Matrix2d C;
    C << std::max(t.covariance[0], kVarianceMin), t.covariance[1], t.covariance[1],
        std::max(t.covariance[2], kVarianceMin);
    if (C.determinant() < kVarianceMin * kVarianceMin) C(0, 1) = C(1, 0) = 0.0;
    Eigen::Matrix<double, 2, 3> H;  // of the motion since the keyframe
    const Eigen::Vector2d arm = point.p_base - motion.T_keyframe_scan.head<2>();
    H << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    point.scan_covariance = R * C * R.transpose() + H * motion.covariance * H.transpose();
    point.floor_sd_m = floor_sd_m(t, config);
    point.covariance =
        point.scan_covariance + point.floor_sd_m * point.floor_sd_m * Eigen::Matrix2d::Identity();
    point.width_m = t.width_m;
    point.width_sd_m = std::max(t.width_sd_m, kWidthSdMin_m);
    if (t.occlusion != 0) point.width_sd_m = std::hypot(point.width_sd_m, t.width_m);
    points.push_back(point);
  }
  return points;
}

}  // namespace orchard::pose
