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
#include "pose/motion.hpp"
#include "pose/pose_config.hpp"
#include "pose/scan_matching/point_map.hpp"
#include "pose/scan_matching/steady_motion.hpp"
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
  explicit ScanMatcher(const PointMap& map) : map_(map) {}

  /// Registers the points, starting from the best of the guesses of T_map_base (at least one).
  /// `turn_max_rad`: how far from the first guess a better fit may be searched for.
  ScanMatch match(const std::vector<SurfacePoint>& points,
                  const std::vector<Eigen::Vector3d>& guesses, double shift_max_m,
                  double turn_max_rad) const;

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
                     double shift_m, double turn_rad, const ScanMatch& found) const;

  /// A pose that the points do not determine.
  ScanMatch unmatched(const std::vector<SurfacePoint>& points,
                      const Eigen::Vector3d& T_map_base) const;
  const PointMap& map_;
};

/// Returns the information of a fit on (x, y) in map and the rotation about the robot [1/m2, 1/m,
/// 1]: the inverse of its covariance.
///
/// It is computed from the pairs and their residuals. Along each axis it is limited to the actual
/// loss of fit when the scan is shifted, because in a dense map every point finds a partner nearby,
/// also along a hedge.
Eigen::Matrix3d information_of(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                               const ScanMatch& match);

/// Returns the covariance of a fit where nothing else is known: undetermined directions keep that
/// of unknown_motion().
Eigen::Matrix3d covariance_of(const ScanMatcher& matcher, const std::vector<SurfacePoint>& points,
                              const ScanMatch& match);

/// Motion of base between two scans.
struct MeasuredMotion {
  std::int64_t utime_from = 0;  ///< of the first beam [us]
  std::int64_t utime_to = 0;
  Eigen::Vector3d T_from_to = Eigen::Vector3d::Zero();   ///< x [m], y [m], yaw [rad]
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of T_from_to
  /// d(T_from_to) / d(speed scale, turn scale, yaw rate bias [rad/s] of the wheels), as far as they
  /// have a part in it.
  Eigen::Matrix3d calibration_jacobian = Eigen::Matrix3d::Zero();
  /// Of T_from_to if that calibration were known.
  Eigen::Matrix3d covariance_calibrated = Eigen::Matrix3d::Zero();
  double matched = 0.0;   ///< fraction of the later scan's points that match the local map
  bool reliable = false;  ///< false: the motion is a prediction or a guess
  bool is_guess = true;   ///< neither a reliable match nor the wheels tell it
  /// False: the scan fits nowhere near where the wheels put it. The motion is then the wheels', and
  /// the next scan tells the motion from `utime_from` on.
  bool has_place = true;
};

/// Estimates the motion of base from scans, by registering each scan to a local map of the previous
/// ones, and from wheels where there are any.
///
/// The motion is the most probable one given what the scan tells and what was expected: what the
/// wheels measured, with their noise and the prior of their calibration; without them, the last
/// motion once more (`SteadyMotion`). So directions that scans do not determine (along a smooth
/// wall, with too few returns) are the wheels', or have a large covariance. A pure function of the
/// sequence of measurements.
class ScanMotion {
 public:
  ScanMotion(const PoseConfig& config, const laser::LaserConfig& mount,
             const laser::BlindSector& blind);

  /// Takes what the wheels measured, in order of time with the scans.
  void add(const Odometry& odometry) { wheels_.add(odometry); }

  /// Returns the motion since the previous scan that has a place. None for the first scan, and for
  /// a scan that is not later than the previous one, which is ignored. All numbers are finite.
  /// `predicted`: the motion as another sensor tells it, one more place to begin the search at.
  std::optional<MeasuredMotion> add(const laser::Scan& scan,
                                    const std::optional<Eigen::Vector3d>& predicted = {});

  /// Returns base in the local map, which begins where base was at the first scan: (x [m], y [m],
  /// yaw [rad]). Good fits mend it after poor ones, so it is surer than the motions one by one.
  const Eigen::Vector3d& T_map_base() const { return T_map_base_; }

 private:
  /// What is expected of a motion before the scan is looked at, in the axes of base before it.
  struct Expected {
    Eigen::Vector3d T_from_to = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = unknown_motion();  ///< of the motion
    Eigen::Matrix3d covariance_calibrated =
        unknown_motion();                          ///< if the wheels' calibration is known
    Eigen::Matrix3d P_base = unknown_motion();     ///< of base in the local map, after it
    Eigen::Matrix3d P_weighed = unknown_motion();  ///< P_base, or of what the last motions foretell
    Eigen::Matrix3d calibration_jacobian = Eigen::Matrix3d::Zero();  ///< of T_from_to
    bool is_guess = true;                                            ///< the wheels tell nothing
    bool is_measured = false;  ///< by the wheels, surely enough to help
  };
  /// What a scan tells, with base in the axes of base before it.
  struct After {
    MeasuredMotion motion;
    Eigen::Vector3d T_map_base;
    Eigen::Matrix3d P_base, D_base;
    double surprise = 1.0;
  };
  Expected expected_at(std::int64_t utime);
  /// `points`: of the scan, corrected for its motion by what is known before and after.
  After matched(const laser::Scan& scan, const Expected& expected,
                const std::optional<Eigen::Vector3d>& predicted,
                std::vector<SurfacePoint>& points) const;
  void remember(const std::vector<SurfacePoint>& points);

  ScanMotionConfig config_;
  Eigen::Vector3d wheels_sd_;  ///< prior of speed scale, turn scale, yaw rate bias
  DeadReckoning wheels_;       ///< motion since the previous scan that has a place
  /// Variance of the wheels' errors over what they state. Until the drive tells, three times the
  /// standard deviation is expected.
  double surprise_ = 9.0;
  laser::LaserConfig mount_;
  laser::BlindSector blind_;
  PointMap map_;
  std::optional<std::int64_t> utime_;
  Eigen::Vector3d T_map_base_ = Eigen::Vector3d::Zero();
  /// Covariance of T_map_base_ in the local map, in the axes of base: after a poor fit the pose may
  /// be wrong, and the next good one mends it.
  Eigen::Matrix3d P_base_ = Eigen::Matrix3d::Zero();
  /// d(T_map_base_) / d(calibration of the wheels), in the axes of base.
  Eigen::Matrix3d D_base_ = Eigen::Matrix3d::Zero();
  bool was_reliable_ = true;
  SteadyMotion steady_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();  ///< per second, in base
  bool velocity_known_ = false;
  double travel_m_ = 0.0;
};

/// Localiser of mode `odometry` with `motion: scans`: dead reckoning by the motions between scans,
/// from the map's origin at the first scan.
class ScanOdometry : public Localiser {
 public:
  ScanOdometry(const PoseConfig& config, const laser::LaserConfig& mount,
               const laser::BlindSector& blind)
      : motion_(config, mount, blind) {}

  /// Takes scans and odometry; other measurements are ignored.
  void add(const Measurement& measurement) override;

  /// Returns the pose at the first beam of the last scan.
  std::optional<PoseEstimate> estimate() const override;

  std::string warning() const override;

 private:
  ScanMotion motion_;
  std::optional<std::int64_t> utime_;
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
  int num_unreliable_ = 0;  ///< consecutive scans without a reliable motion
};

}  // namespace orchard::pose
