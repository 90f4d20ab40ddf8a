// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_grid.hpp"
#include "pose/field_of_view.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// T_map_base in a prior map where one trunk cannot be told from the next: a sum of Gaussians, one
/// for each place where base may be.
///
/// An observation may be a landmark seen again or something that is not in the map, and a landmark
/// in view is seen or missed; how many are is unknown. The likelihood of a place is a mixture over
/// the fraction that is seen and over all partners of a landmark. So clutter makes no place sure,
/// and places at which the trunks fit alike keep their share until ends of rows, gaps and lone
/// trunks decide.
class PlaceBelief {
 public:
  /// The most probable place, with all Gaussians less than half a spacing from it.
  struct Place {
    Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    double probability = 0.0;
    double num_seen = 0.0;  ///< landmarks seen in a scan, over the last pass of a trunk
    double seen = 0.0;      ///< as a fraction of those in view
    double held_m = 0.0;    ///< travel since another place was the most probable
  };

  explicit PlaceBelief(const PriorMap& map);

  /// Starts from a Gaussian.
  void start(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance);
  /// Starts from a place that somebody stated: one in ten of these is off by some spacings.
  void start_stated(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance);

  /// Starts anywhere within one and a half spacings of a landmark, with any heading. False, and no
  /// change, where these are more places than can be weighed.
  bool start_anywhere();

  /// Moves all places by T_base_next (x [m], y [m], yaw [rad]) with its covariance; `travel_m`: the
  /// length of the way.
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance, double travel_m);

  /// Corrects the places by a scan, in proportion to the travel since the scan that last did: a
  /// trunk in view for long counts once. Returns false before a third of a metre, without a change.
  bool correct(const std::vector<ScanObservation>& observations, const FieldOfView& field);

  const Place& place() const { return place_; }
  /// The probability of all places less than half a spacing from the pose, as of the last
  /// correction.
  double probability_at(const Eigen::Vector3d& T_map_base) const;
  std::size_t num_places() const { return places_.size(); }
  /// True where base may be at more places than can be weighed.
  bool is_spread_out() const;

 private:
  struct Gaussian {
    Eigen::Vector3d T_map_base;
    Eigen::Matrix3d covariance;
    double weight;
    double seen = 0.0, expected = 0.0;  ///< landmarks in a scan, over the last pass of a trunk
  };
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
  class SeenAndMissed;
  class ViewOfScan;

  std::vector<Target> targets_of(const std::vector<ScanObservation>& observations) const;
  double correct(Gaussian& place, const std::vector<Target>& targets, const ViewOfScan& view,
                 double share) const;
  std::vector<Partner> partners_of(const Gaussian& place, const std::vector<Target>& targets) const;
  void find_partners(const Gaussian& place, const Target& target,
                     std::vector<Partner>& partners) const;
  double add_missed(const Gaussian& place, const ViewOfScan& view, SeenAndMissed& seen) const;
  void forget_motion();
  void move_places();
  void split();
  bool split(std::size_t place);
  void merge();
  void prune();
  bool is_near(const Gaussian& place, const Eigen::Vector3d& T_map_base) const;
  Place sum_around(const Eigen::Vector3d& T_map_base) const;

  const PriorMap& map_;
  double place_sd_m_;         ///< of a Gaussian, at most
  double reach_m_;            ///< beyond it a landmark is no partner of an observation
  geometry::PointGrid grid_;  ///< of the landmarks, for queries of reach_m_
  std::vector<Gaussian> places_;
  std::size_t places_max_ = 0;
  Place place_;
  // Since the last correction.
  double travel_m_ = 0.0;
  Eigen::Vector3d T_then_now_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P_then_now_ = Eigen::Matrix3d::Zero();
};

}  // namespace orchard::pose
