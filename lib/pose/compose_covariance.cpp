// SPDX-License-Identifier: BSD-3-Clause
#include "pose/compose_covariance.hpp"

#include <mrpt/poses/CPosePDFGaussian.h>

namespace orchard::pose {
namespace {

using mrpt::poses::CPosePDFGaussian;

CPosePDFGaussian gaussian(const Eigen::Vector3d& T, const Eigen::Matrix3d& P) {
  return {mrpt::poses::CPose2D(T.x(), T.y(), T.z()), mrpt::math::CMatrixDouble33(P)};
}

}  // namespace

Eigen::Matrix3d compose_covariance(const Eigen::Vector3d& T_a_b, const Eigen::Matrix3d& P_ab,
                                   const Eigen::Vector3d& T_b_c, const Eigen::Matrix3d& P_bc) {
  CPosePDFGaussian T_a_c = gaussian(T_a_b, P_ab);
  T_a_c += gaussian(T_b_c, P_bc);
  const Eigen::Matrix3d P = T_a_c.cov.asEigen();
  return 0.5 * (P + P.transpose());
}

}  // namespace orchard::pose
