// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "detection/detection.hpp"
#include "pose/field_of_view.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// Returns the usable observations of a scan, corrected by the velocity of base from the time of
/// each to that of the scan. Values not finite, invalid covariances and objects beyond
/// observation_range_max_m are left out.
std::vector<ScanObservation> scan_observations(const detection::Detections& seen, double speed_mps,
                                               double yaw_rate_radps, const PriorMapConfig& config);

/// Local map of the trunks along the last metres of travel: EKF-SLAM over base and trunks, in its
/// own frame. It is independent of the prior map, so that positions in that map can be compared by
/// whole trunks instead of single observations, of which one wrong trunk yields dozens.
class LocalTrunkMap {
 public:
  struct Trunk {
    Eigen::Vector2d p_local = Eigen::Vector2d::Zero();
    Eigen::Matrix2d covariance =
        Eigen::Matrix2d::Zero();  ///< against base at the last reset_origin()
    double width_m = 0.0;         ///< 0 = unknown
    double width_sd_m = 0.0;
    double last_travel_m = 0.0;  ///< travel when it was last seen
    int num_seen = 0;
    int num_expected = 0;  ///< scans that saw it or should have
    int num_near = 0;      ///< other trunks within `clump_reach_m`
    double sd_m = 0.0;     ///< scatter of its observations beyond their covariance, e.g. because
                           ///< each side of a bush shows another centre
  };

  /// A viewpoint with the occlusions seen from it.
  struct View {
    Eigen::Vector3d T_local_base = Eigen::Vector3d::Zero();
    geometry::OcclusionTest occlusion;
    double travel_m = 0.0;
  };

  explicit LocalTrunkMap(const PriorMapConfig& config);

  /// Clears the map; keeps the travel. Base becomes the origin.
  void clear();

  /// Predicts the motion of base by T_base_next with its covariance, along `travel_m` of path.
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance, double travel_m);

  void observe(const std::vector<ScanObservation>& observations, const FieldOfView& field);

  /// Moves the frame's origin to the present base. Invalidates all results in the previous frame.
  void reset_origin();

  /// Returns the trunks that were seen often enough to be real, the last seen first.
  /// `clump_reach_m`: max distance between parts of one clump, see Trunk::num_near.
  std::vector<Trunk> trunks(double clump_reach_m = 0.0) const;
  const std::deque<View>& views() const { return views_; }
  const Eigen::Vector3d& T_local_base() const { return T_local_base_; }
  const Eigen::Matrix3d& pose_covariance() const { return pose_covariance_; }
  double travel_m() const { return travel_m_; }

  /// True if several consecutive scans have missed most of the expected trunks: base did not move
  /// as measured.
  bool is_inconsistent() const { return num_inconsistent_scans_ >= kInconsistentScans; }

  /// True if the last scan has more contradictions than matches: trunks seen beside known ones or
  /// where none should be, or missing.
  bool last_scan_contradicts() const { return last_scan_contradicts_; }

 private:
  static constexpr int kInconsistentScans = 5;  // derived: half a second

  struct Entry {
    int num_seen = 0;
    int num_expected = 0;  ///< scans that saw it or should have
    int num_missed_in_a_row = 0;
    double last_travel_m = 0.0;
    double excess_m2 = 0.0;  ///< sum of squared innovations minus their covariance, per axis
    double width_sum_m = 0.0;
    double width_sum_m2 = 0.0;
    double width_noise_m2 = 0.0;
    int num_widths = 0;
    double width_sum = 0.0;  ///< weighted by inverse variance
    double width_weight = 0.0;
  };

  bool is_confirmed(const Entry& entry) const;
  int match(const ScanObservation& observation, const std::vector<bool>& taken,
            double& nearest_m) const;
  void correct(int trunk, const ScanObservation& observation);
  void insert(const ScanObservation& observation);
  int longest_unseen() const;
  void remove(int trunk);
  void remove_old_trunks();
  Eigen::Vector2d p_local(int trunk) const { return x_.segment<2>(3 + 2 * trunk); }

  PriorMapConfig config_;
  Eigen::VectorXd x_;  ///< base (x, y, yaw), then the trunks' (x, y)
  Eigen::MatrixXd P_;
  Eigen::Vector3d T_local_base_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d pose_covariance_ = Eigen::Matrix3d::Zero();
  std::vector<Entry> entries_;
  std::deque<View> views_;
  double travel_m_ = 0.0;
  int num_inconsistent_scans_ = 0;
  bool last_scan_contradicts_ = false;
};

}  // namespace orchard::pose
