// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/factors.hpp"

#include <ceres/sized_cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "geometry/pose2.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {
using geometry::between;
using geometry::rotation;
using geometry::transform;

namespace {

/// Min standard deviation of a receiver's correlated error [m]; derived: far below any receiver's.
constexpr double kReceiverSdMin_m = 0.001;

double receiver_sd_m(const ReceiverModel& model, const ReceiverError& error) {
  return std::hypot(kReceiverSdMin_m, std::sqrt(model.correlated * error.claimed_variance));
}

/// Returns d(R(yaw)) / d(yaw) * v, given rotated = R(yaw) * v.
Eigen::Vector2d turned(const Eigen::Vector2d& rotated) { return {-rotated.y(), rotated.x()}; }

// Returns the upper triangular W with W^T W = inverse(covariance), which whitens an error.
template <int Size>
Eigen::Matrix<double, Size, Size> whitening(const Eigen::Matrix<double, Size, Size>& covariance) {
  using Matrix = Eigen::Matrix<double, Size, Size>;
  // A minimum far below any sensor noise keeps a zero covariance invertible.
  const Matrix P = covariance + 1e-10 * Matrix::Identity();
  // Of dynamic size, as the solver needs it anyway: every other size costs the compiler a second.
  return Eigen::LLT<Eigen::MatrixXd>(P.inverse()).matrixU();
}

/// One evaluation of a factor with `Rows` residuals.
template <int Rows>
struct Evaluation {
  double const* const* parameters;
  double* residuals;
  double** jacobians;  ///< null: not wanted, as are null ones among them

  template <int Size>
  Eigen::Map<const Eigen::Matrix<double, Size, 1>> at(int block) const {
    return Eigen::Map<const Eigen::Matrix<double, Size, 1>>(parameters[block]);
  }
  template <class Values>
  void set_residual(const Values& values) const {
    Eigen::Map<Eigen::Matrix<double, Rows, 1>>{residuals} = values;
  }
  bool wants_derivative(int block) const {
    return jacobians != nullptr && jacobians[block] != nullptr;
  }
  template <class Values>
  void set_derivative(int block, const Values& values) const {
    constexpr int kColumns = Values::ColsAtCompileTime;  // derived: of the type
    // derived: Eigen knows a column in column order only.
    constexpr int kOrder = kColumns == 1 ? Eigen::ColMajor : Eigen::RowMajor;
    if (!wants_derivative(block)) return;
    Eigen::Map<Eigen::Matrix<double, Rows, kColumns, kOrder>>{jacobians[block]} = values;
  }
};

/// A factor of `Rows` residuals and parameter blocks of these sizes; `evaluate` takes an
/// Evaluation.
template <int Rows, int... Sizes, class Function>
ceres::CostFunction* new_factor(Function evaluate) {
  class Factor : public ceres::SizedCostFunction<Rows, Sizes...> {
   public:
    explicit Factor(Function evaluate) : evaluate_(std::move(evaluate)) {}
    bool Evaluate(double const* const* parameters, double* residuals,
                  double** jacobians) const override {
      evaluate_(Evaluation<Rows>{parameters, residuals, jacobians});
      return true;
    }

   private:
    Function evaluate_;
  };
  return new Factor(std::move(evaluate));
}

/// Position in map of a point of base that W whitens, minus the measured one; with the receiver's
/// error as a second parameter if `has_error`.
void evaluate_position(const Evaluation<2>& e, const Eigen::Vector2d& p_base,
                       const Eigen::Vector2d& p_map, const Eigen::Matrix2d& W, bool has_error) {
  const auto T = e.at<3>(0);
  const Eigen::Vector2d arm = rotation(T.z()) * p_base;
  if (has_error) {
    e.set_residual(W * (T.head<2>() + arm + e.at<2>(1) - p_map));
    e.set_derivative(1, W);
  } else {
    e.set_residual(W * (T.head<2>() + arm - p_map));
  }
  if (!e.wants_derivative(0)) return;
  Eigen::Matrix<double, 2, 3> J;
  J.leftCols<2>() = W;
  J.col(2) = W * turned(arm);
  e.set_derivative(0, J);
}

/// A parameter block minus its prior mean, whitened by W.
template <int Size>
ceres::CostFunction* prior_factor(const Eigen::Matrix<double, Size, 1>& mean,
                                  const Eigen::Matrix<double, Size, Size>& covariance) {
  return new_factor<Size, Size>([mean, W = whitening(covariance)](const Evaluation<Size>& e) {
    e.set_residual(W * (e.template at<Size>(0) - mean));
    e.set_derivative(0, W);
  });
}

}  // namespace

BasePlacement::BasePlacement(const Eigen::Vector3d& T_map_base)
    : p_map(T_map_base.head<2>()), R_base_map(rotation(T_map_base.z()).transpose()) {}

ObservationResidual::ObservationResidual(const SlamObservation& observation, double noise)
    : p_base_(observation.position()),
      W_(whitening(Eigen::Matrix2d(noise * observation.covariance()))) {}

Eigen::Matrix<double, 2, 3> ObservationResidual::by_pose(const BasePlacement& base,
                                                         const Eigen::Vector2d& p_map) const {
  Eigen::Matrix<double, 2, 3> J;
  J.leftCols<2>() = -W_ * base.R_base_map;
  J.col(2) = -W_ * turned(seen(base, p_map));
  return J;
}

ceres::CostFunction* motion_factor(const RelativeMotion& motion,
                                   const Eigen::Matrix3d& covariance) {
  return new_factor<3, 3, 3, 3>([motion, W = whitening(covariance)](const Evaluation<3>& e) {
    const Eigen::Vector3d a = e.at<3>(0), b = e.at<3>(1);
    Eigen::Vector3d error = between(a, b) - motion.delta_with(e.at<3>(2));
    error.z() = geometry::wrap_angle_rad(error.z());
    e.set_residual(W * error);
    if (e.jacobians == nullptr) return;
    const Eigen::Matrix2d R_t = rotation(a.z()).transpose();
    Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
    J.topLeftCorner<2, 2>() = R_t;
    e.set_derivative(1, W * J);
    J = -J;
    J.topRightCorner<2, 1>() = -turned(R_t * (b - a).head<2>());
    e.set_derivative(0, W * J);
    e.set_derivative(2, -W * motion.calibration_jacobian);
  });
}

ceres::CostFunction* landmark_prior_factor(const Eigen::Vector2d& p_map,
                                           const Eigen::Matrix2d& covariance) {
  return prior_factor(p_map, covariance);
}

ceres::CostFunction* calibration_prior_factor(const OdometryCalibration& mean,
                                              const Eigen::Matrix3d& covariance) {
  return prior_factor(mean, covariance);
}

ceres::CostFunction* calibration_walk_factor(const Eigen::Vector3d& kept,
                                             const Eigen::Vector3d& sd) {
  const Eigen::Vector3d inverse_sd = (sd.array() + 1e-6).inverse().matrix();
  return new_factor<3, 3, 3>([kept, inverse_sd](const Evaluation<3>& e) {
    e.set_residual(inverse_sd.cwiseProduct(e.at<3>(1) - kept.cwiseProduct(e.at<3>(0))));
    e.set_derivative(0, Eigen::Matrix3d((-inverse_sd.cwiseProduct(kept)).asDiagonal()));
    e.set_derivative(1, Eigen::Matrix3d(inverse_sd.asDiagonal()));
  });
}

ceres::CostFunction* absolute_position_factor(const AbsolutePosition& position) {
  return new_factor<2, 3>([p_base = transform(position.T_keyframe_then, position.lever_base_m),
                           p_map = position.p_map,
                           W = whitening(position.covariance)](const Evaluation<2>& e) {
    evaluate_position(e, p_base, p_map, W, false);
  });
}

ceres::CostFunction* receiver_position_factor(const AbsolutePosition& position, double noise) {
  return new_factor<2, 3, 2>(
      [p_base = transform(position.T_keyframe_then, position.lever_base_m), p_map = position.p_map,
       W = whitening(Eigen::Matrix2d(noise * position.covariance))](const Evaluation<2>& e) {
        evaluate_position(e, p_base, p_map, W, true);
      });
}

ceres::CostFunction* receiver_error_factor(const ReceiverModel& model, const ReceiverError& before,
                                           const ReceiverError& after) {
  const double dt_s = 1e-6 * static_cast<double>(after.utime - before.utime);
  const double kept = std::exp(-dt_s / kReceiverMemory_s);
  const double inverse_sd = 1.0 / (receiver_sd_m(model, after) * std::sqrt(1.0 - kept * kept));
  return new_factor<2, 2, 2>([kept, inverse_sd](const Evaluation<2>& e) {
    e.set_residual(inverse_sd * (e.at<2>(1) - kept * e.at<2>(0)));
    const Eigen::Matrix2d J = inverse_sd * Eigen::Matrix2d::Identity();
    e.set_derivative(0, -kept * J);
    e.set_derivative(1, J);
  });
}

ceres::CostFunction* receiver_error_prior_factor(const ReceiverModel& model,
                                                 const ReceiverError& error) {
  const double sd_m = receiver_sd_m(model, error);
  return landmark_prior_factor(Eigen::Vector2d::Zero(), sd_m * sd_m * Eigen::Matrix2d::Identity());
}

ceres::CostFunction* heading_factor(const AbsolutePosition& position) {
  const double yaw_rad = position.yaw_rad - position.T_keyframe_then.z();  // of the keyframe
  const double inverse_sd = 1.0 / position.yaw_sd_rad;
  return new_factor<1, 3>([yaw_rad, inverse_sd](const Evaluation<1>& e) {
    using Scalar = Eigen::Matrix<double, 1, 1>;
    e.set_residual(Scalar(inverse_sd * geometry::wrap_angle_rad(e.at<3>(0).z() - yaw_rad)));
    e.set_derivative(0, Eigen::RowVector3d(0.0, 0.0, inverse_sd));
  });
}

}  // namespace orchard::pose
