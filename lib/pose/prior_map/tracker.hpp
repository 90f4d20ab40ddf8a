// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "pose/prior_map/expected_view.hpp"
#include "pose/prior_map/prior_map.hpp"
#include "pose/prior_map/prior_map_config.hpp"
#include "pose/prior_map/watch.hpp"

namespace orchard::pose {

/// What wheels say of a stretch of time.
struct WheelStep {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
  std::array<double, 3> covariance{};  ///< var speed, cov, var yaw rate
  double dt_s = 0.0;
};

/// T_map_base by the landmarks of a prior map, once it is known about: an extended Kalman filter
/// over base and what its wheels get wrong (their scale, the scale of their turns, a yaw rate's
/// bias). Sightings are matched jointly: each match narrows the gates of the next one.
class PriorMapTracker {
 public:
  /// How one scan went with the map.
  struct Matching {
    int num_matched = 0;
    std::vector<ExpectedLandmark> expected;  ///< that should have been seen for sure
  };

  PriorMapTracker(const PriorMap& map, const PriorMapConfig& config);

  /// Begins at a place. What is known of the wheels stays.
  void start(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance);

  void move(const WheelStep& step);
  /// A motion of base that was measured otherwise than by wheels.
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance);
  Matching correct(const std::vector<Sighting>& sightings, const SightField& field);

  Eigen::Vector3d T_map_base() const { return x_.head<3>(); }
  Eigen::Matrix3d covariance() const { return P_.topLeftCorner<3, 3>(); }

  /// What the wheels truly did, by what is known of them: T_before_after.
  Eigen::Vector3d motion(const WheelStep& step) const;
  /// Its covariance for who does not estimate the wheels' errors: what is not known of them counts
  /// as noise that adds up to the same over a headland turn.
  Eigen::Matrix3d motion_covariance(const WheelStep& step) const;

 private:
  using State = Eigen::Matrix<double, 6, 1>;  ///< x, y, yaw, speed scale, turn scale, yaw rate bias
  using Covariance = Eigen::Matrix<double, 6, 6>;

  struct Match {
    std::int32_t landmark = -1;
    double d2 = 0.0;
    Eigen::Vector2d innovation = Eigen::Vector2d::Zero();
  };
  Eigen::Matrix3d noise(const WheelStep& step) const;
  Match best_match(const Sighting& sighting, const std::vector<std::int32_t>& taken) const;
  void update(const Sighting& sighting, const Match& match);
  Eigen::Matrix<double, 2, 6> jacobian(const Sighting& sighting) const;

  const PriorMap& map_;
  PriorMapConfig config_;
  State x_ = State::Zero();
  Covariance P_ = Covariance::Zero();
};

}  // namespace orchard::pose
