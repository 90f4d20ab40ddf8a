// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pose/prior_map/local_map.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// T_map_base in a prior map where it is too vague to tell which landmark a trunk is: a Gaussian,
/// updated over a grid of poses.
///
/// Any trunk around may be a landmark seen again or something that is not in the map; how many are
/// is unknown. The likelihood of each pose of the grid is a mixture of both over all trunks,
/// without a choice of partners, and mean and covariance of the Gaussian are those of the grid. So
/// clutter does not make it sure, and where the trunks fit at two poses its covariance spans both.
class VaguePose {
 public:
  explicit VaguePose(const PriorMap& map);

  void start(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance);
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance);

  /// Corrects the pose by the trunks around, relative to base. `share`: of the evidence of a trunk
  /// that this update may use, in (0, 1], because other updates use the same trunks.
  void correct(const std::vector<LocalTrunkMap::Trunk>& around, double share);

  const Eigen::Vector3d& T_map_base() const { return T_map_base_; }
  const Eigen::Matrix3d& covariance() const { return P_; }

 private:
  struct Axis {
    Eigen::Vector3d step;  ///< x [m], y [m], yaw [rad]
    double step_sigmas = 0.0;
    int num = 0;  ///< steps to either side
  };
  struct Target {
    Eigen::Vector2d p_base;
    double variance_m2;
    double clutter_per_m2;  ///< density of what is not in the map, by the trunks around this one
  };
  static std::vector<Target> targets_of(const std::vector<LocalTrunkMap::Trunk>& trunks);
  std::array<Axis, 3> axes(double reach_m) const;
  double density_at(const Eigen::Vector2d& p_map, double variance_m2) const;
  double log_likelihood(const std::vector<Target>& targets,
                        const Eigen::Vector3d& T_map_base) const;

  const PriorMap& map_;
  double sd_max_m_ = 0.0;  ///< of a landmark
  Eigen::Vector3d T_map_base_ = Eigen::Vector3d::Zero();
  Eigen::Matrix3d P_ = Eigen::Matrix3d::Zero();
};

}  // namespace orchard::pose
