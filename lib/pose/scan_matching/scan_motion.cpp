// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/scan_motion.hpp"

#include <cmath>
#include <variant>

#include "geometry/pose2.hpp"
#include "pose/motion.hpp"
#include "pose/scan_matching/scan_matcher.hpp"

namespace orchard::pose {

using geometry::between;
using geometry::compose;
using geometry::rotation;
namespace {

// derived: one return for each square, so that near surfaces, which get most, do not outweigh far
// ones [m]; drift does not double a wall within this travel [m].
constexpr double kThinning_m = 0.10;
constexpr int kPointsMin = 20;
constexpr double kMapTravel_m = 15.0;

// physical: a motion known as well between two scans still tells neighbouring trunks apart.
constexpr double kReliableShiftSd_m = 0.10;
constexpr double kReliableTurnSd_rad = 0.03;

bool is_sure(const Eigen::Matrix3d& covariance) {
  // Larger eigenvalue of the 2x2 position covariance.
  const double half_trace = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double deviation =
      std::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
  return half_trace + deviation <= kReliableShiftSd_m * kReliableShiftSd_m &&
         covariance(2, 2) <= kReliableTurnSd_rad * kReliableTurnSd_rad;
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
  motion.covariance = unknown_motion();
  std::vector<SurfacePoint> few = thinned(points, kThinning_m);
  const double period_s = 1e-6 * static_cast<double>(scan.utime - *utime_);
  const bool is_swept = config_.deskew && scan.beam_period_us > 0.0;
  Eigen::Vector3d straight_on = last_motion_;
  straight_on.z() = 0.0;
  const std::vector<Eigen::Vector3d> guesses{compose(T_map_base_, last_motion_),
                                             compose(T_map_base_, straight_on), T_map_base_};
  Eigen::Vector3d T_map_base = guesses.front();
  const bool comparable = static_cast<int>(few.size()) >= kPointsMin && !map_.empty();
  if (comparable) {
    const ScanMatcher matcher(map_, config_);
    ScanMatch match = matcher.match(few, guesses);
    if (is_swept && velocity_known_) {
      velocity_ = between(T_map_base_, match.T_map_base) / period_s;
      points = surface_points(scan, mount_, blind_, velocity_, config_);
      few = thinned(points, kThinning_m);
      match = matcher.match(few, {match.T_map_base});
    }
    motion.matched = match.matched;
    const Eigen::Matrix3d P_map = covariance_of(matcher, few, match);
    T_map_base = remap_pose(match, P_map, guesses.front());
    // Rotate the covariance from map into the axes of base at the previous scan.
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    R.topLeftCorner<2, 2>() = rotation(-T_map_base_.z());
    motion.covariance = R * P_map * R.transpose();
    motion.reliable = match.score >= kScoreReliable && is_sure(motion.covariance);
  }
  motion.T_from_to = between(T_map_base_, T_map_base);

  travel_m_ += motion.T_from_to.head<2>().norm();
  last_motion_ = motion.T_from_to;
  velocity_ = motion.T_from_to / period_s;
  T_map_base_ = T_map_base;
  utime_ = scan.utime;
  if (is_swept && !velocity_known_) {
    // The first scan was not deskewed because the velocity was unknown: restart the map.
    map_.clear();
    points = surface_points(scan, mount_, blind_, velocity_, config_);
  }
  velocity_known_ = true;
  remember(points);
  return motion;
}

void ScanMotion::remember(const std::vector<SurfacePoint>& points) {
  if (kMapTravel_m > 0.0) map_.forget_before(travel_m_ - kMapTravel_m);
  const Eigen::Matrix2d R = rotation(T_map_base_.z());
  for (const SurfacePoint& point : points) {
    SurfacePoint placed = point;
    placed.p = R * point.p + T_map_base_.head<2>();
    placed.normal = R * point.normal;
    map_.insert(placed, travel_m_);
  }
}

void ScanOdometry::add(const Measurement& measurement) {
  const auto* scan = std::get_if<laser::Scan>(&measurement);
  if (!scan) return;
  const std::optional<MeasuredMotion> motion = motion_.add(*scan);
  if (!motion) {
    if (!utime_) utime_ = scan->utime;
    return;
  }
  covariance_ = compose_covariance(T_map_base_, covariance_, motion->T_from_to, motion->covariance);
  T_map_base_ = compose(T_map_base_, motion->T_from_to);
  utime_ = motion->utime_to;
  num_unreliable_ = motion->reliable ? 0 : num_unreliable_ + 1;
}

std::optional<PoseEstimate> ScanOdometry::estimate() const {
  if (!utime_) return std::nullopt;
  return pose_estimate(*utime_, T_map_base_, covariance_);
}

std::string ScanOdometry::warning() const {
  if (num_unreliable_ == 0) return {};
  return "LOST: the last " + std::to_string(num_unreliable_) +
         " scans could not be matched (too few returns, no overlap with earlier scans, or only "
         "smooth walls); the path is extrapolated from there on";
}

}  // namespace orchard::pose
