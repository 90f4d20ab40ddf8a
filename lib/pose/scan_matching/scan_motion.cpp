// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/scan_motion.hpp"

#include <cmath>

#include "geometry/pose2.hpp"
#include "pose/scan_matching/scan_covariance.hpp"
#include "pose/scan_matching/scan_matcher.hpp"

namespace orchard::pose {
using geometry::between;
using geometry::compose;
using geometry::rotation;

namespace {

bool is_sure(const Eigen::Matrix3d& covariance, const ScanMotionConfig& config) {
  // of a 2x2: half the trace plus the root of its deviation is the larger eigenvalue
  const double half_trace = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double deviation =
      std::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
  return half_trace + deviation <= config.reliable_shift_sd_m * config.reliable_shift_sd_m &&
         covariance(2, 2) <= config.reliable_turn_sd_rad * config.reliable_turn_sd_rad;
}

}  // namespace

ScanMotion::ScanMotion(const ScanMotionConfig& config, const laser::LaserConfig& mount,
                       const laser::BlindSector& blind)
    : config_(config), mount_(mount), blind_(blind), map_(config_) {}

std::optional<MeasuredMotion> ScanMotion::add(const laser::Scan& scan) {
  if (utime_ && scan.utime <= *utime_) return std::nullopt;
  std::vector<SurfacePoint> points = surface_points(scan, mount_, blind_, velocity_, config_);
  if (!utime_) {
    utime_ = scan.utime;
    remember(points);
    return std::nullopt;
  }

  MeasuredMotion motion;
  motion.utime_from = *utime_;
  motion.utime_to = scan.utime;
  motion.covariance = unknown_motion(config_);
  std::vector<SurfacePoint> few = thinned(points, config_.thin_m);
  const double period_s = 1e-6 * static_cast<double>(scan.utime - *utime_);
  const bool is_swept = config_.deskew && scan.beam_period_us > 0.0;
  Eigen::Vector3d straight_on = last_motion_;
  straight_on.z() = 0.0;
  const std::vector<Eigen::Vector3d> guesses{compose(T_map_base_, last_motion_),
                                             compose(T_map_base_, straight_on), T_map_base_};
  Eigen::Vector3d T_map_base = guesses.front();
  const bool comparable = static_cast<int>(few.size()) >= config_.points_min && !map_.empty();
  if (comparable) {
    const ScanMatcher matcher(map_, config_);
    ScanMatch match = matcher.match(few, guesses);
    if (is_swept && velocity_known_) {
      velocity_ = between(T_map_base_, match.T_map_base) / period_s;
      points = surface_points(scan, mount_, blind_, velocity_, config_);
      few = thinned(points, config_.thin_m);
      match = matcher.match(few, {match.T_map_base});
    }
    motion.matched = match.matched;
    T_map_base = match.T_map_base;
    // of base's own axes at the scan before
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    R.topLeftCorner<2, 2>() = rotation(-T_map_base_.z());
    motion.covariance = R * covariance_of(matcher, few, match, config_) * R.transpose();
    motion.reliable = match.score >= config_.score_reliable && is_sure(motion.covariance, config_);
  }
  motion.T_from_to = between(T_map_base_, T_map_base);

  travel_m_ += motion.T_from_to.head<2>().norm();
  last_motion_ = motion.T_from_to;
  velocity_ = motion.T_from_to / period_s;
  T_map_base_ = T_map_base;
  utime_ = scan.utime;
  if (is_swept && !velocity_known_) {
    // the first scan was placed without a velocity: the map begins anew with one that has it
    map_.clear();
    points = surface_points(scan, mount_, blind_, velocity_, config_);
  }
  velocity_known_ = true;
  remember(points);
  return motion;
}

void ScanMotion::remember(const std::vector<SurfacePoint>& points) {
  if (config_.map_travel_m > 0.0) map_.forget_before(travel_m_ - config_.map_travel_m);
  const Eigen::Matrix2d R = rotation(T_map_base_.z());
  for (const SurfacePoint& point : points) {
    SurfacePoint placed = point;
    placed.p = R * point.p + T_map_base_.head<2>();
    placed.normal = R * point.normal;
    map_.insert(placed, travel_m_);
  }
}

}  // namespace orchard::pose
