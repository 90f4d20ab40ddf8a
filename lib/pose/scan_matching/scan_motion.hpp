// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"
#include "pose/scan_matching/point_map.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {

/// Kernel width of the final score [m]: scale of the distance between a point and the map; derived:
/// half of kKernel_m.
inline constexpr double kScoreKernel_m = 0.15;

/// Result of registering a scan to the local map.
struct ScanMatch {
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  double score = 0.0;    ///< how well the points fit, 0 to 1
  double matched = 0.0;  ///< fraction of the points that have a partner
  /// Information on (x, y) in map and the rotation about the robot, to be divided by the residual
  /// variance; smooth surfaces give none along themselves.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double residual_variance_m2 = 0.0;
  double weight = 0.0;  ///< sum over all pairs; a pair without residual has weight 1
};

/// Registers a scan to the local map by robust ICP: point-to-line on smooth surfaces,
/// point-to-point elsewhere (after Censi's PL-ICP and KISS-ICP). After a bad fit it searches
/// all turns and the neighbourhood, wider if nothing there fits; among fits that are as good, the
/// predicted pose is kept.
class ScanMatcher {
 public:
  ScanMatcher(const PointMap& map, const ScanMotionConfig& config) : map_(map), config_(config) {}

  /// Registers the points, starting from the best of the guesses of T_map_base (at least one).
  ScanMatch match(const std::vector<SurfacePoint>& points,
                  const std::vector<Eigen::Vector3d>& guesses) const;

  /// Registers the points from one guess by ICP, without a search.
  ScanMatch refined(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& guess) const;

  /// Returns the fit of the points at a pose: the mean of exp(-d^2 / (2 kernel_m^2)) over the
  /// points, with d the distance to the nearest point of the map.
  double score(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& T_map_base,
               double kernel_m) const;

 private:
  void iterate(const std::vector<SurfacePoint>& points, double pair_m, double kernel_m,
               ScanMatch& match) const;
  ScanMatch searched(const std::vector<SurfacePoint>& points, const Eigen::Vector3d& centre,
                     double shift_m, const ScanMatch& found) const;

  /// A pose that the points do not determine.
  ScanMatch unmatched(const std::vector<SurfacePoint>& points,
                      const Eigen::Vector3d& T_map_base) const;
  const PointMap& map_;
  const ScanMotionConfig& config_;
};

/// Returns the covariance of a fit: of (x, y) in map and the rotation about the robot.
///
/// It is computed from the information of the pairs and their residuals. Along each axis the
/// information is limited to the actual loss of fit when the scan is shifted, because in a dense
/// map every point finds a partner nearby, also along a hedge. Undetermined directions keep the
/// covariance of unknown_motion().
Eigen::Matrix3d covariance_of(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                              const ScanMatch& match);

/// Returns the pose of a fit, with the predicted position in directions that the scan does not
/// determine, if the fit has slid along them, e.g. along a hedge (solution remapping: Zhang, Kaess,
/// Singh 2016).
Eigen::Vector3d remap_pose(const ScanMatch& match, const Eigen::Matrix3d& covariance,
                           const Eigen::Vector3d& T_map_expected);

/// Returns the covariance of a motion that is only predicted.
Eigen::Matrix3d unknown_motion();

/// Motion of base between two scans.
struct MeasuredMotion {
  std::int64_t utime_from = 0;  ///< of the first beam [us]
  std::int64_t utime_to = 0;
  Eigen::Vector3d T_from_to = Eigen::Vector3d::Zero();   ///< x [m], y [m], yaw [rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of T_from_to
  double matched = 0.0;   ///< fraction of the later scan's points that match the local map
  bool reliable = false;  ///< false: the motion is a prediction or a guess
};

/// Estimates the motion of base from scans alone, by registering each scan to a local map of the
/// previous ones.
///
/// The prediction repeats the last motion per scan, not per second, because time stamps of
/// recordings may be stretched. Directions that the scans do not determine (along a smooth wall,
/// with too few returns) get a large covariance. A pure function of the sequence of scans.
class ScanMotion {
 public:
  ScanMotion(const ScanMotionConfig& config, const laser::LaserConfig& mount,
             const laser::BlindSector& blind);

  /// Returns the motion since the previous scan. None for the first scan, and for a scan that is
  /// not later than the previous one, which is ignored. All numbers are finite. `predicted`:
  /// the motion as another sensor tells it, one more place to begin the search at.
  std::optional<MeasuredMotion> add(const laser::Scan& scan,
                                    const std::optional<Eigen::Vector3d>& predicted = {});

 private:
  void remember(const std::vector<SurfacePoint>& points);

  ScanMotionConfig config_;
  laser::LaserConfig mount_;
  laser::BlindSector blind_;
  PointMap map_;
  std::optional<std::int64_t> utime_;
  Eigen::Vector3d T_map_base_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d last_motion_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();  ///< per second, in base
  bool velocity_known_ = false;
  double travel_m_ = 0.0;
};

/// Localiser of mode `odometry` with `motion: scans`: dead reckoning by the motions between scans,
/// from the map's origin at the first scan.
class ScanOdometry : public Localiser {
 public:
  ScanOdometry(const ScanMotionConfig& config, const laser::LaserConfig& mount,
               const laser::BlindSector& blind)
      : motion_(config, mount, blind) {}

  /// Takes scans; other measurements are ignored.
  void add(const Measurement& measurement) override;

  /// Returns the pose at the first beam of the last scan.
  std::optional<PoseEstimate> estimate() const override;

  std::string warning() const override;

 private:
  ScanMotion motion_;
  std::optional<std::int64_t> utime_;
  Eigen::Vector3d T_map_base_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
  int num_unreliable_ = 0;  ///< consecutive scans without a reliable motion
};

}  // namespace orchard::pose
