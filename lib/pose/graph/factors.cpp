// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/factors.hpp"

#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "geometry/pose2.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {
using geometry::between;
using geometry::rotation;
using geometry::transform;

namespace {

/// Min standard deviation of a receiver's correlated error [m].
constexpr double kReceiverSdMin_m = 0.001;

double receiver_sd_m(const ReceiverModel& model, const ReceiverError& error) {
  return std::hypot(kReceiverSdMin_m, std::sqrt(model.correlated * error.claimed_variance));
}

template <int Rows, int Columns>
using RowMajor = Eigen::Map<
    Eigen::Matrix<double, Rows, Columns, Columns == 1 ? Eigen::ColMajor : Eigen::RowMajor>>;
using Vector2Map = Eigen::Map<const Eigen::Vector2d>;
using Vector3Map = Eigen::Map<const Eigen::Vector3d>;

/// Returns d(R(yaw)) / d(yaw) * v, given rotated = R(yaw) * v.
Eigen::Vector2d turned(const Eigen::Vector2d& rotated) { return {-rotated.y(), rotated.x()}; }

// Returns the upper triangular W with W^T W = inverse(covariance), which whitens an error.
template <int Size>
Eigen::Matrix<double, Size, Size> whitening(const Eigen::Matrix<double, Size, Size>& covariance) {
  using Matrix = Eigen::Matrix<double, Size, Size>;
  // A minimum far below any sensor noise keeps a zero covariance invertible.
  const Matrix P = covariance + 1e-10 * Matrix::Identity();
  return P.inverse().llt().matrixU();
}

class MotionFactor : public ceres::SizedCostFunction<3, 3, 3, 3> {
 public:
  MotionFactor(const RelativeMotion& motion, const Eigen::Matrix3d& covariance);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  RelativeMotion motion_;
  Eigen::Matrix3d W_;
};

class LandmarkPriorFactor : public ceres::SizedCostFunction<2, 2> {
 public:
  LandmarkPriorFactor(const Eigen::Vector2d& p_map, const Eigen::Matrix2d& covariance);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector2d p_map_;
  Eigen::Matrix2d W_;
};

class CalibrationPriorFactor : public ceres::SizedCostFunction<3, 3> {
 public:
  CalibrationPriorFactor(const OdometryCalibration& mean, const Eigen::Matrix3d& covariance);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  OdometryCalibration mean_;
  Eigen::Matrix3d W_;
};

class CalibrationWalkFactor : public ceres::SizedCostFunction<3, 3, 3> {
 public:
  CalibrationWalkFactor(const Eigen::Vector3d& kept, const Eigen::Vector3d& sd);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d kept_;
  Eigen::Vector3d inverse_sd_;
};

class AbsolutePositionFactor : public ceres::SizedCostFunction<2, 3> {
 public:
  explicit AbsolutePositionFactor(const AbsolutePosition& position);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector2d p_base_;  //< the point, in base at the keyframe
  Eigen::Vector2d p_map_;
  Eigen::Matrix2d W_;
};

class ReceiverPositionFactor : public ceres::SizedCostFunction<2, 3, 2> {
 public:
  ReceiverPositionFactor(const AbsolutePosition& position, double noise)
      : p_base_(transform(position.T_keyframe_then, position.lever_base_m)),
        p_map_(position.p_map),
        W_(whitening(Eigen::Matrix2d(noise * position.covariance))) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Vector3Map T(parameters[0]);
    const Eigen::Vector2d arm = rotation(T.z()) * p_base_;
    Eigen::Map<Eigen::Vector2d>{residuals} =
        W_ * (T.head<2>() + arm + Vector2Map(parameters[1]) - p_map_);
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      RowMajor<2, 3> J{jacobians[0]};
      J.leftCols<2>() = W_;
      J.col(2) = W_ * turned(arm);
    }
    if (jacobians[1] != nullptr) RowMajor<2, 2>{jacobians[1]} = W_;
    return true;
  }

 private:
  Eigen::Vector2d p_base_;
  Eigen::Vector2d p_map_;
  Eigen::Matrix2d W_;
};

class ReceiverErrorFactor : public ceres::SizedCostFunction<2, 2, 2> {
 public:
  ReceiverErrorFactor(double kept, double sd_m) : kept_(kept), inverse_sd_(1.0 / sd_m) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::Vector2d>{residuals} =
        inverse_sd_ * (Vector2Map(parameters[1]) - kept_ * Vector2Map(parameters[0]));
    if (jacobians == nullptr) return true;
    const Eigen::Matrix2d J = inverse_sd_ * Eigen::Matrix2d::Identity();
    if (jacobians[0] != nullptr) RowMajor<2, 2>{jacobians[0]} = -kept_ * J;
    if (jacobians[1] != nullptr) RowMajor<2, 2>{jacobians[1]} = J;
    return true;
  }

 private:
  double kept_;
  double inverse_sd_;
};

class HeadingFactor : public ceres::SizedCostFunction<1, 3> {
 public:
  explicit HeadingFactor(const AbsolutePosition& position);
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
  const Vector3Map calibration(parameters[2]);
  Eigen::Vector3d error = between(a, b) - motion_.delta_with(calibration);
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
  if (jacobians[2] != nullptr) RowMajor<3, 3>{jacobians[2]} = -W_ * motion_.calibration_jacobian;
  return true;
}

LandmarkPriorFactor::LandmarkPriorFactor(const Eigen::Vector2d& p_map,
                                         const Eigen::Matrix2d& covariance)
    : p_map_(p_map), W_(whitening(covariance)) {}

bool LandmarkPriorFactor::Evaluate(double const* const* parameters, double* residuals,
                                   double** jacobians) const {
  Eigen::Map<Eigen::Vector2d>{residuals} = W_ * (Vector2Map(parameters[0]) - p_map_);
  if (jacobians != nullptr && jacobians[0] != nullptr) RowMajor<2, 2>{jacobians[0]} = W_;
  return true;
}

CalibrationPriorFactor::CalibrationPriorFactor(const OdometryCalibration& mean,
                                               const Eigen::Matrix3d& covariance)
    : mean_(mean), W_(whitening(covariance)) {}

bool CalibrationPriorFactor::Evaluate(double const* const* parameters, double* residuals,
                                      double** jacobians) const {
  Eigen::Map<Eigen::Vector3d>{residuals} = W_ * (Vector3Map(parameters[0]) - mean_);
  if (jacobians != nullptr && jacobians[0] != nullptr) RowMajor<3, 3>{jacobians[0]} = W_;
  return true;
}

CalibrationWalkFactor::CalibrationWalkFactor(const Eigen::Vector3d& kept, const Eigen::Vector3d& sd)
    : kept_(kept), inverse_sd_((sd.array() + 1e-6).inverse().matrix()) {}

bool CalibrationWalkFactor::Evaluate(double const* const* parameters, double* residuals,
                                     double** jacobians) const {
  Eigen::Map<Eigen::Vector3d>{residuals} = inverse_sd_.cwiseProduct(
      Vector3Map(parameters[1]) - kept_.cwiseProduct(Vector3Map(parameters[0])));
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    RowMajor<3, 3>{jacobians[0]} = (-inverse_sd_.cwiseProduct(kept_)).asDiagonal();
  }
  if (jacobians[1] != nullptr) RowMajor<3, 3>{jacobians[1]} = inverse_sd_.asDiagonal();
  return true;
}

AbsolutePositionFactor::AbsolutePositionFactor(const AbsolutePosition& position)
    : p_base_(transform(position.T_keyframe_then, position.lever_base_m)),
      p_map_(position.p_map),
      W_(whitening(position.covariance)) {}

bool AbsolutePositionFactor::Evaluate(double const* const* parameters, double* residuals,
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

HeadingFactor::HeadingFactor(const AbsolutePosition& position)
    : yaw_rad_(position.yaw_rad - position.T_keyframe_then.z()),
      inverse_sd_(1.0 / position.yaw_sd_rad) {}

bool HeadingFactor::Evaluate(double const* const* parameters, double* residuals,
                             double** jacobians) const {
  residuals[0] = inverse_sd_ * geometry::wrap_angle_rad(parameters[0][2] - yaw_rad_);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    RowMajor<1, 3>{jacobians[0]} << 0.0, 0.0, inverse_sd_;
  }
  return true;
}

}  // namespace

BasePlacement::BasePlacement(const Eigen::Vector3d& T_map_base)
    : p_map(T_map_base.head<2>()), R_base_map(rotation(T_map_base.z()).transpose()) {}

ObservationResidual::ObservationResidual(const SlamObservation& observation)
    : p_base_(observation.position()), W_(whitening(observation.covariance())) {}

Eigen::Matrix<double, 2, 3> ObservationResidual::by_pose(const BasePlacement& base,
                                                         const Eigen::Vector2d& p_map) const {
  Eigen::Matrix<double, 2, 3> J;
  J.leftCols<2>() = -W_ * base.R_base_map;
  J.col(2) = -W_ * turned(seen(base, p_map));
  return J;
}

ceres::CostFunction* motion_factor(const RelativeMotion& motion,
                                   const Eigen::Matrix3d& covariance) {
  return new MotionFactor(motion, covariance);
}
ceres::CostFunction* landmark_prior_factor(const Eigen::Vector2d& p_map,
                                           const Eigen::Matrix2d& covariance) {
  return new LandmarkPriorFactor(p_map, covariance);
}
ceres::CostFunction* calibration_prior_factor(const OdometryCalibration& mean,
                                              const Eigen::Matrix3d& covariance) {
  return new CalibrationPriorFactor(mean, covariance);
}
ceres::CostFunction* calibration_walk_factor(const Eigen::Vector3d& kept,
                                             const Eigen::Vector3d& sd) {
  return new CalibrationWalkFactor(kept, sd);
}
ceres::CostFunction* absolute_position_factor(const AbsolutePosition& position) {
  return new AbsolutePositionFactor(position);
}
ceres::CostFunction* receiver_position_factor(const AbsolutePosition& position, double noise) {
  return new ReceiverPositionFactor(position, noise);
}
ceres::CostFunction* receiver_error_factor(const ReceiverModel& model, const ReceiverError& before,
                                           const ReceiverError& after) {
  const double dt_s = 1e-6 * static_cast<double>(after.utime - before.utime);
  const double kept = std::exp(-dt_s / kReceiverMemory_s);
  return new ReceiverErrorFactor(kept, receiver_sd_m(model, after) * std::sqrt(1.0 - kept * kept));
}
ceres::CostFunction* receiver_error_prior_factor(const ReceiverModel& model,
                                                 const ReceiverError& error) {
  const double sd_m = receiver_sd_m(model, error);
  return new LandmarkPriorFactor(Eigen::Vector2d::Zero(),
                                 sd_m * sd_m * Eigen::Matrix2d::Identity());
}
ceres::CostFunction* heading_factor(const AbsolutePosition& position) {
  return new HeadingFactor(position);
}

}  // namespace orchard::pose
