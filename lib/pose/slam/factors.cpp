// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/factors.hpp"

#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "pose/planar.hpp"

namespace orchard::pose {
namespace {

template <int Rows, int Columns>
using RowMajor = Eigen::Map<
    Eigen::Matrix<double, Rows, Columns, Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor>>;
using Vector2Map = Eigen::Map<const Eigen::Vector2d>;
using Vector3Map = Eigen::Map<const Eigen::Vector3d>;

/// d(R(yaw)) / d(yaw) * v for R(yaw) * v = rotated.
Eigen::Vector2d turned(const Eigen::Vector2d& rotated) { return {-rotated.y(), rotated.x()}; }

// Upper triangular W with W^T W = inverse(covariance): divides an error by its standard deviation.
template <int Size>
Eigen::Matrix<double, Size, Size> whitening(const Eigen::Matrix<double, Size, Size>& covariance) {
  using Matrix = Eigen::Matrix<double, Size, Size>;
  // a floor far below any sensor keeps what is stated as exact invertible
  const Matrix P = covariance + 1e-10 * Matrix::Identity();
  return P.inverse().llt().matrixU();
}

class MotionFactor : public ceres::SizedCostFunction<3, 3, 3, 3> {
 public:
  // `covariance` is of motion.delta, perhaps with what the pose before adds to it.
  MotionFactor(const RelativeMotion& motion, const Eigen::Matrix3d& covariance);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  RelativeMotion motion_;
  Eigen::Matrix3d W_;
};

class SightingFactor : public ceres::SizedCostFunction<2, 3, 2> {
 public:
  explicit SightingFactor(const SlamSighting& sighting);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector2d p_base_;
  Eigen::Matrix2d W_;
};

class PlaceFactor : public ceres::SizedCostFunction<2, 2> {
 public:
  PlaceFactor(const Eigen::Vector2d& p_map, const Eigen::Matrix2d& covariance);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector2d p_map_;
  Eigen::Matrix2d W_;
};

class ErrorsPriorFactor : public ceres::SizedCostFunction<3, 3> {
 public:
  ErrorsPriorFactor(const WheelErrors& mean, const Eigen::Matrix3d& covariance);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  WheelErrors mean_;
  Eigen::Matrix3d W_;
};

class ErrorsWalkFactor : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  explicit ErrorsWalkFactor(const Eigen::Vector3d& sd);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d inverse_sd_;
};

class FixFactor : public ceres::SizedCostFunction<2, 3> {
 public:
  explicit FixFactor(const PlaceFix& fix);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector2d p_base_;  //< of the point, in base at the keyframe
  Eigen::Vector2d p_map_;
  Eigen::Matrix2d W_;
};

class HeadingFactor : public ceres::SizedCostFunction<1, 3> {
 public:
  explicit HeadingFactor(const PlaceFix& fix);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  double yaw_rad_;  //< of the keyframe
  double inverse_sd_;
};

MotionFactor::MotionFactor(const RelativeMotion& motion, const Eigen::Matrix3d& covariance)
    : motion_(motion), W_(whitening(covariance)) {}

bool MotionFactor::Evaluate(double const* const* parameters, double* residuals,
                            double** jacobians) const {
  const Vector3Map a(parameters[0]);
  const Vector3Map b(parameters[1]);
  const Vector3Map errors(parameters[2]);
  Eigen::Vector3d error = between(a, b) - motion_.delta_with(errors);
  error.z() = geometry::wrap_angle_rad(error.z());
  Eigen::Map<Eigen::Vector3d>{residuals} = W_ * error;
  if (jacobians == nullptr) return true;
  const Eigen::Matrix2d R_t = rotation(a.z()).transpose();
  Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  J.topLeftCorner<2, 2>() = R_t;
  if (jacobians[1] != nullptr) RowMajor<3, 3>{jacobians[1]} = W_ * J;
  if (jacobians[0] != nullptr) {
    J = -J;
    J.topRightCorner<2, 1>() = -turned(R_t * (b - a).head<2>());
    RowMajor<3, 3>{jacobians[0]} = W_ * J;
  }
  if (jacobians[2] != nullptr) RowMajor<3, 3>{jacobians[2]} = -W_ * motion_.error_jacobian;
  return true;
}

SightingFactor::SightingFactor(const SlamSighting& sighting)
    : p_base_(sighting.position()), W_(whitening(sighting.covariance())) {}

bool SightingFactor::Evaluate(double const* const* parameters, double* residuals,
                              double** jacobians) const {
  const Vector3Map T(parameters[0]);
  const Vector2Map p(parameters[1]);
  const Eigen::Matrix2d R_t = rotation(T.z()).transpose();
  const Eigen::Vector2d seen = R_t * (p - T.head<2>());
  Eigen::Map<Eigen::Vector2d>{residuals} = W_ * (seen - p_base_);
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    RowMajor<2, 3> J{jacobians[0]};
    J.leftCols<2>() = -W_ * R_t;
    J.col(2) = -W_ * turned(seen);
  }
  if (jacobians[1] != nullptr) RowMajor<2, 2>{jacobians[1]} = W_ * R_t;
  return true;
}

PlaceFactor::PlaceFactor(const Eigen::Vector2d& p_map, const Eigen::Matrix2d& covariance)
    : p_map_(p_map), W_(whitening(covariance)) {}

bool PlaceFactor::Evaluate(double const* const* parameters, double* residuals,
                           double** jacobians) const {
  Eigen::Map<Eigen::Vector2d>{residuals} = W_ * (Vector2Map(parameters[0]) - p_map_);
  if (jacobians != nullptr && jacobians[0] != nullptr) RowMajor<2, 2>{jacobians[0]} = W_;
  return true;
}

ErrorsPriorFactor::ErrorsPriorFactor(const WheelErrors& mean, const Eigen::Matrix3d& covariance)
    : mean_(mean), W_(whitening(covariance)) {}

bool ErrorsPriorFactor::Evaluate(double const* const* parameters, double* residuals,
                                 double** jacobians) const {
  Eigen::Map<Eigen::Vector3d>{residuals} = W_ * (Vector3Map(parameters[0]) - mean_);
  if (jacobians != nullptr && jacobians[0] != nullptr) RowMajor<3, 3>{jacobians[0]} = W_;
  return true;
}

ErrorsWalkFactor::ErrorsWalkFactor(const Eigen::Vector3d& sd)
    : inverse_sd_((sd.array() + 1e-6).inverse().matrix()) {}

bool ErrorsWalkFactor::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  Eigen::Map<Eigen::Vector3d>{residuals} =
      inverse_sd_.cwiseProduct(Vector3Map(parameters[1]) - Vector3Map(parameters[0]));
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) RowMajor<3, 3>{jacobians[0]} = (-inverse_sd_).asDiagonal();
  if (jacobians[1] != nullptr) RowMajor<3, 3>{jacobians[1]} = inverse_sd_.asDiagonal();
  return true;
}

FixFactor::FixFactor(const PlaceFix& fix)
    : p_base_(transform(fix.T_keyframe_then, fix.lever_base_m)),
      p_map_(fix.p_map),
      W_(whitening(fix.covariance)) {}

bool FixFactor::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const Vector3Map T(parameters[0]);
  const Eigen::Vector2d arm = rotation(T.z()) * p_base_;
  Eigen::Map<Eigen::Vector2d>{residuals} = W_ * (T.head<2>() + arm - p_map_);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    RowMajor<2, 3> J{jacobians[0]};
    J.leftCols<2>() = W_;
    J.col(2) = W_ * turned(arm);
  }
  return true;
}

HeadingFactor::HeadingFactor(const PlaceFix& fix)
    : yaw_rad_(fix.yaw_rad - fix.T_keyframe_then.z()), inverse_sd_(1.0 / fix.yaw_sd_rad) {}

bool HeadingFactor::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  residuals[0] = inverse_sd_ * geometry::wrap_angle_rad(parameters[0][2] - yaw_rad_);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    RowMajor<1, 3>{jacobians[0]} << 0.0, 0.0, inverse_sd_;
  }
  return true;
}

}  // namespace

ceres::CostFunction* motion_term(const RelativeMotion& motion, const Eigen::Matrix3d& covariance) {
  return new MotionFactor(motion, covariance);
}
ceres::CostFunction* sighting_term(const SlamSighting& sighting) {
  return new SightingFactor(sighting);
}
ceres::CostFunction* place_term(const Eigen::Vector2d& p_map, const Eigen::Matrix2d& covariance) {
  return new PlaceFactor(p_map, covariance);
}
ceres::CostFunction* errors_prior_term(const WheelErrors& mean, const Eigen::Matrix3d& covariance) {
  return new ErrorsPriorFactor(mean, covariance);
}
ceres::CostFunction* errors_walk_term(const Eigen::Vector3d& sd) {
  return new ErrorsWalkFactor(sd);
}
ceres::CostFunction* fix_term(const PlaceFix& fix) { return new FixFactor(fix); }
ceres::CostFunction* heading_term(const PlaceFix& fix) { return new HeadingFactor(fix); }

}  // namespace orchard::pose
