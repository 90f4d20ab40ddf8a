// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "pose/prior_map/expected_view.hpp"
#include "pose/prior_map/prior_map_config.hpp"

namespace orchard::pose {

/// The trunks around the last metres of travel, in a frame of their own: SLAM by an extended
/// Kalman filter over base and trunks. It knows nothing of the prior map, which is how one place
/// of that map can be held against another by whole trunks rather than by sightings, of which one
/// wrong trunk makes dozens.
class LocalTrunkMap {
 public:
  struct Trunk {
    Eigen::Vector2d p_local = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< against base at the last anchor()
    double width_m = 0.0;                                  ///< 0 = unknown
    double width_sd_m = 0.0;
    double last_travel_m = 0.0;  ///< of base when it was last seen
    int num_seen = 0;
    int num_expected = 0;  ///< scans that saw it or should have
    int num_near = 0;      ///< other trunks within the reach that was asked for
    double sd_m = 0.0;     ///< of its position by itself: how its sightings scatter beyond
                           ///< what they state, as each side of a bush shows another middle
  };

  /// A place from which was looked.
  struct View {
    Eigen::Vector3d T_local_base = Eigen::Vector3d::Zero();
    geometry::OcclusionTest occlusion;
    double travel_m = 0.0;
  };

  explicit LocalTrunkMap(const PriorMapConfig& config);

  /// Forgets everything but the travel: begins anew at base.
  void clear();

  /// Base moves by T_base_next with its covariance, along `travel_m` of path.
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance, double travel_m);

  void observe(const std::vector<Sighting>& sightings, const SightField& field);

  /// Makes base, as it is now, the frame's origin. Nothing that was asked in the frame before
  /// holds.
  void anchor();

  /// The trunks that were seen often enough to be there, the one seen last first.
  /// Parts of one clump stand within `clump_reach_m`.
  std::vector<Trunk> trunks(double clump_reach_m = 0.0) const;
  const std::deque<View>& views() const { return views_; }
  const Eigen::Vector3d& T_local_base() const { return T_local_base_; }
  const Eigen::Matrix3d& pose_covariance() const { return pose_covariance_; }
  double travel_m() const { return travel_m_; }

  /// Whether scans, for some time, have shown little of the trunks that they should have: base did
  /// not move as odometry says.
  bool broken() const { return num_broken_scans_ >= kBrokenScans; }

  /// Whether the last scan alone speaks rather of another place than of where base should be.
  bool surprised() const { return surprised_; }

 private:
  static constexpr int kBrokenScans = 5;

  struct Entry {
    int num_seen = 0;
    int num_expected = 0;  ///< scans that saw it or should have
    int num_missed_in_a_row = 0;
    double last_travel_m = 0.0;
    double excess_m2 = 0.0;  ///< of squared innovations over their covariance, summed, per axis
    double width_sum_m = 0.0;
    double width_sum_m2 = 0.0;
    double width_noise_m2 = 0.0;
    int num_widths = 0;
    double width_sum = 0.0;  ///< weighted by inverse variance
    double width_weight = 0.0;
  };

  bool is_sure(const Entry& entry) const;
  int match(const Sighting& sighting, const std::vector<bool>& taken, double& nearest_m) const;
  void correct(int trunk, const Sighting& sighting);
  void insert(const Sighting& sighting);
  void remove(int trunk);
  void forget_what_is_old();
  Eigen::Vector2d p_local(int trunk) const { return x_.segment<2>(3 + 2 * trunk); }

  PriorMapConfig config_;
  Eigen::VectorXd x_;  ///< base (x, y, yaw), then the trunks' (x, y)
  Eigen::MatrixXd P_;
  Eigen::Vector3d T_local_base_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d pose_covariance_ = Eigen::Matrix3d::Zero();
  std::vector<Entry> entries_;
  std::deque<View> views_;
  double travel_m_ = 0.0;
  int num_broken_scans_ = 0;
  bool surprised_ = false;
};

}  // namespace orchard::pose
