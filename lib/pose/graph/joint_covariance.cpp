// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/joint_covariance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <vector>

#include "geometry/pose2.hpp"

namespace orchard::pose {

JointCovariance joint_covariance(const Keyframe& keyframe) {
  JointCovariance P;
  P << keyframe.covariance, keyframe.calibration_cross, keyframe.calibration_cross.transpose(),
      keyframe.calibration_covariance;
  return P;
}

void set_joint_covariance(const JointCovariance& covariance, Keyframe& keyframe) {
  keyframe.covariance = covariance.topLeftCorner<3, 3>();
  keyframe.calibration_cross = covariance.topRightCorner<3, 3>();
  keyframe.calibration_covariance = covariance.bottomRightCorner<3, 3>();
}

JointCovariance after_motion(const JointCovariance& before, const Eigen::Vector3d& T_map_before,
                             const RelativeMotion& motion, const Eigen::Vector3d& delta) {
  const Eigen::Matrix3d G = geometry::compose_jacobian_second(T_map_before);
  JointCovariance F = JointCovariance::Identity();
  F.topLeftCorner<3, 3>() = geometry::compose_jacobian_first(T_map_before, delta);
  F.topRightCorner<3, 3>() = G * motion.calibration_jacobian;
  JointCovariance P = F * before * F.transpose();
  P.topLeftCorner<3, 3>() += G * motion.covariance * G.transpose();
  return 0.5 * (P + P.transpose());
}

std::optional<JointCovariance> after_measurements(const JointCovariance& prior,
                                                  const Eigen::MatrixXd& information,
                                                  const JointIndices& known,
                                                  const JointIndices& wanted) {
  std::vector<int> rest;
  for (int i = 0; i < static_cast<int>(information.rows()); ++i) {
    if (std::find(known.begin(), known.end(), i) == known.end()) rest.push_back(i);
  }
  const Eigen::MatrixXd H_rest = information(rest, rest);
  const Eigen::MatrixXd H_cross = information(rest, known);
  const Eigen::LLT<Eigen::MatrixXd> factor(H_rest);
  if (factor.info() != Eigen::Success) return std::nullopt;
  // Condition the rest on the known unknowns (gain `follows`); `told` is the information of the
  // measurements on the known ones after marginalising the rest.
  const Eigen::MatrixXd follows = -factor.solve(H_cross);
  const JointCovariance told = information(known, known) + H_cross.transpose() * follows;
  const JointCovariance known_then =
      (JointCovariance::Identity() + prior * told).partialPivLu().solve(prior);
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rest.size()), 6);
  for (int w = 0; w < 6; ++w) {
    const auto is_known = std::find(known.begin(), known.end(), wanted[w]);
    if (is_known != known.end()) {
      A(w, is_known - known.begin()) = 1.0;
      continue;
    }
    const auto at = std::find(rest.begin(), rest.end(), wanted[w]) - rest.begin();
    A.row(w) = follows.row(at);
    unit(at, w) = 1.0;
  }
  const JointCovariance own = unit.transpose() * factor.solve(unit);
  const JointCovariance P = A * known_then * A.transpose() + own;
  if (!P.allFinite()) return std::nullopt;
  return JointCovariance(0.5 * (P + P.transpose()));
}

}  // namespace orchard::pose
