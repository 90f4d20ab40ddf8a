// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/point_grid.hpp"
#include "pose/field_of_view.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// A Gaussian over T_map_base (x [m], y [m], yaw [rad]).
struct WeighedPlace {
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double weight = 1.0;
  double seen = 0.0, expected = 0.0;  ///< landmarks in a scan, over the last pass of a trunk
  double known = 1.0;  ///< share of the things in the last scan that stand where the map was made

  /// Moves it by T_base_next with its covariance.
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance_next);
};

/// Returns a - b, the yaw wrapped.
Eigen::Vector3d pose_difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b);
/// Returns T + step, the yaw wrapped.
Eigen::Vector3d stepped(const Eigen::Vector3d& T, const Eigen::Vector3d& step);

/// The likelihood of a scan at places of a prior map where one trunk cannot be told from the next.
///
/// An observation may be a landmark seen again or something that is not in the map, and a landmark
/// in view is seen or missed; how many are is unknown. The likelihood of a place is a mixture over
/// the fraction that is seen and over all partners of a landmark. Where the map was not made stand
/// trees, too, in the same pattern: what is seen there tells as much as at another place of the
/// map where the pattern fits.
class PlaceLikelihood {
 public:
  /// One scan, prepared for thousands of places.
  class ScanView;

  explicit PlaceLikelihood(const PriorMap& map);

  /// Standard deviation of a place that has one partner for a trunk [m], [rad].
  double place_sd_m() const { return place_sd_m_; }
  double place_sd_rad() const;
  /// True if the poses are less than half a spacing from each other, hence one place.
  bool are_near(const Eigen::Vector3d& a, const Eigen::Vector3d& b) const;

  /// Corrects a place by all partners of the landmarks in view, each with its probability and with
  /// `share` of its information. Returns the logarithm of the likelihood of the whole scan over
  /// that of clutter alone.
  double correct(WeighedPlace& place, const ScanView& scan, double share) const;

 private:
  class SeenAndMissed;
  struct Target {
    Eigen::Vector2d p_base;
    double variance_m2;
    double clutter_per_m2;  ///< density of what is not in the map, by the observations around
  };
  struct Partner {
    Eigen::Vector2d arm_m, offset_m;  ///< in the axes of map: base to observation, on to landmark
    double variance_m2;
    std::int32_t landmark;
    double ratio;  ///< density of the observation as this landmark, over that as clutter
  };

  static std::vector<Target> targets_of(const std::vector<ScanObservation>& observations);
  void find_partners(const WeighedPlace& place, const Eigen::Vector2d& arm_m, const Target& target,
                     std::vector<Partner>& partners) const;
  std::vector<Partner> partners_of(const WeighedPlace& place, const std::vector<Target>& targets,
                                   std::size_t& num_unknown) const;
  double add_missed(const WeighedPlace& place, const ScanView& scan, SeenAndMissed& seen) const;

  const PriorMap& map_;
  double place_sd_m_;
  double reach_m_;            ///< beyond it a landmark is no partner of an observation
  geometry::PointGrid grid_;  ///< of the landmarks, for queries of reach_m_
};

/// What a scan tells of a point of base: whether a trunk there would be in view, and how far the
/// nearest observation is. A raster, because thousands of places ask.
class PlaceLikelihood::ScanView {
 public:
  ScanView(const std::vector<ScanObservation>& observations, const FieldOfView& field);

  double range_m() const { return range_m_; }
  const std::vector<Target>& targets() const { return targets_; }
  /// What a thing tells where the map was not made: the logarithm of its likelihood over clutter's.
  double log_unknown() const { return log_unknown_; }
  void set_log_unknown(double log_unknown) { log_unknown_ = log_unknown; }
  /// Distance to the nearest observation [m]; negative where nothing is in view.
  double nearest_m(const Eigen::Vector2d& p_base) const;

 private:
  double range_m_;
  int half_;
  std::vector<Target> targets_;
  std::vector<float> nearest_m_;
  double log_unknown_ = 0.0;
};

}  // namespace orchard::pose
