// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/window_problem.hpp"

#include <ceres/cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <cstdint>
#include <utility>

#include "geometry/angles.hpp"

namespace orchard::pose {

struct WindowProblem::Factor {
  std::unique_ptr<ceres::CostFunction> residual;
  bool is_robust = false;
  bool is_own = false;
  std::vector<int> blocks;
};

struct WindowProblem::Observation {
  int pose = 0;  ///< block
  ObservationResidual residual;
};

struct WindowProblem::LinearisedObservation {
  int row = 0;  ///< of its pose in the equations
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 3> by_pose;
  Eigen::Matrix2d by_position;
};

struct WindowProblem::Landmark {
  int id = 0;
  int value = 0;
  std::unique_ptr<ceres::CostFunction> prior;
  std::vector<Observation> observations;
  // of the last linearise()
  std::vector<LinearisedObservation> linearised;
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();  ///< undamped
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
};

WindowProblem::WindowProblem(const SlamGraph& graph, int first) : graph_(graph), first_(first) {}
WindowProblem::~WindowProblem() = default;

int WindowProblem::add_block(const Eigen::VectorXd& value, bool is_fixed, bool is_pose) {
  Block block;
  block.size = static_cast<int>(value.size());
  block.value = static_cast<int>(start_.size());
  block.is_pose = is_pose;
  if (!is_fixed) block.row = std::exchange(num_rows_, num_rows_ + block.size);
  start_.insert(start_.end(), value.begin(), value.end());
  blocks_.push_back(block);
  return static_cast<int>(blocks_.size()) - 1;
}

int WindowProblem::pose(int keyframe) {
  const auto [at, is_new] = poses_.try_emplace(keyframe, 0);
  if (is_new) {
    at->second = add_block(graph_.keyframes[keyframe].T_map_base, keyframe < first_, true);
  }
  return at->second;
}

int WindowProblem::calibration(int index) {
  const auto [at, is_new] = calibrations_.try_emplace(index, 0);
  if (is_new) at->second = add_block(graph_.calibrations[index], false, false);
  return at->second;
}

int WindowProblem::receiver_error(int index) {
  const auto [at, is_new] = receiver_errors_.try_emplace(index, 0);
  if (is_new) at->second = add_block(graph_.receiver_errors[index].p_m, false, false);
  return at->second;
}

void WindowProblem::add(ceres::CostFunction* residual, bool is_robust, bool is_own,
                        std::vector<int> blocks) {
  factors_.push_back(
      {std::unique_ptr<ceres::CostFunction>(residual), is_robust, is_own, std::move(blocks)});
}

void WindowProblem::add_motion(int keyframe, const Eigen::Matrix3d& covariance, bool is_own) {
  const Keyframe& k = graph_.keyframes[keyframe];
  add(motion_factor(k.motion, covariance), false, is_own,
      {pose(keyframe - 1), pose(keyframe), calibration(k.calibration)});
}

void WindowProblem::add_relative_pose(const RelativePose& relative, bool is_own) {
  RelativeMotion motion;
  motion.delta = relative.T_from_to;
  add(motion_factor(motion, relative.covariance), true, is_own,
      {pose(relative.from), pose(relative.to),
       calibration(graph_.keyframes[relative.to].calibration)});
}

void WindowProblem::add_observation(int keyframe, const SlamObservation& observation) {
  const auto [at, is_new] = landmark_at_.try_emplace(observation.landmark, landmarks_.size());
  if (is_new) {
    Landmark& landmark = landmarks_.emplace_back();
    landmark.id = observation.landmark;
    landmark.value = static_cast<int>(start_.size());
    const Eigen::Vector2d& p_map = graph_.landmarks[observation.landmark].p_map;
    start_.insert(start_.end(), {p_map.x(), p_map.y()});
  }
  landmarks_[at->second].observations.push_back({pose(keyframe), ObservationResidual(observation)});
}

void WindowProblem::add_positions(int keyframe) {
  if (!graph_.georeferenced) return;
  for (const AbsolutePosition& p : graph_.keyframes[keyframe].positions) {
    if (p.is_displaced) continue;
    if (p.receiver_error >= 0) {
      add(receiver_position_factor(p, graph_.receiver.noise), true, true,
          {pose(keyframe), receiver_error(p.receiver_error)});
    } else {
      add(absolute_position_factor(p), true, true, {pose(keyframe)});
    }
    if (p.has_yaw) add(heading_factor(p), true, true, {pose(keyframe)});
  }
}

// The loss is robust because the error jumps when reflections of the signal begin or end.
void WindowProblem::add_receiver_errors() {
  const std::pair<const int, int>* before = nullptr;
  for (const auto& now : receiver_errors_) {
    const ReceiverError& error = graph_.receiver_errors[now.first];
    if (before == nullptr) {
      add(receiver_error_prior_factor(graph_.receiver, error), true, true, {now.second});
    } else {
      add(receiver_error_factor(graph_.receiver, graph_.receiver_errors[before->first], error),
          true, true, {before->second, now.second});
    }
    before = &now;
  }
}

void WindowProblem::add_landmark_prior(int landmark, const Eigen::Vector2d& p_map,
                                       const Eigen::Matrix2d& covariance) {
  landmarks_[landmark_at_.at(landmark)].prior.reset(landmark_prior_factor(p_map, covariance));
}

void WindowProblem::add_calibration_prior(int index, const CalibrationPrior& prior) {
  add(calibration_prior_factor(prior.mean, prior.covariance), false, false, {calibration(index)});
}

void WindowProblem::add_calibration_walk(int index, const Eigen::Vector3d& kept) {
  add(calibration_walk_factor(kept, graph_.calibration_walk_sd), false, true,
      {calibration(index - 1), calibration(index)});
}

/// Computes the rotations of the poses once for all their observations.
void WindowProblem::place(const Eigen::VectorXd& values) {
  placed_.assign(blocks_.size(), BasePlacement(Eigen::Vector3d::Zero()));
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (blocks_[b].is_pose) placed_[b] = BasePlacement(values.segment<3>(blocks_[b].value));
  }
}

double WindowProblem::cost(const Eigen::VectorXd& values) {
  place(values);
  double sum = 0.0;
  for (const Factor& factor : factors_) {
    std::array<const double*, 3> at{};
    for (std::size_t i = 0; i < factor.blocks.size(); ++i) {
      at[i] = values.data() + blocks_[factor.blocks[i]].value;
    }
    Eigen::Vector3d r = Eigen::Vector3d::Zero();
    factor.residual->Evaluate(at.data(), r.data(), nullptr);
    sum += loss_of(r.squaredNorm(), factor.is_robust, kOutlier_sigma).cost;
  }
  for (const Landmark& landmark : landmarks_) {
    const Eigen::Vector2d p = values.segment<2>(landmark.value);
    if (landmark.prior) {
      const double* at = p.data();
      Eigen::Vector2d r;
      landmark.prior->Evaluate(&at, r.data(), nullptr);
      sum += loss_of(r.squaredNorm(), true, kOutlier_sigma).cost;
    }
    for (const Observation& o : landmark.observations) {
      const Eigen::Vector2d r = o.residual.at(placed_[o.pose], p);
      sum += loss_of(r.squaredNorm(), true, kOutlier_sigma).cost;
    }
  }
  return sum;
}

void WindowProblem::add_factor(const Factor& factor, const Eigen::VectorXd& values) {
  const int num_residuals = factor.residual->num_residuals();
  std::array<const double*, 3> at{};
  std::array<std::array<double, 9>, 3> derivatives{};
  std::array<double*, 3> to{};
  for (std::size_t i = 0; i < factor.blocks.size(); ++i) {
    at[i] = values.data() + blocks_[factor.blocks[i]].value;
    to[i] = derivatives[i].data();
  }
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  factor.residual->Evaluate(at.data(), r.data(), to.data());
  const double slope = loss_of(r.squaredNorm(), factor.is_robust, kOutlier_sigma).slope;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
  const auto J = [&](std::size_t i) {
    return Eigen::Map<const Rows>(derivatives[i].data(), num_residuals,
                                  blocks_[factor.blocks[i]].size);
  };
  for (std::size_t i = 0; i < factor.blocks.size(); ++i) {
    const Block& a = blocks_[factor.blocks[i]];
    if (a.row == kFixed) continue;
    for (std::size_t j = 0; j < factor.blocks.size(); ++j) {
      const Block& b = blocks_[factor.blocks[j]];
      if (b.row == kFixed || b.row > a.row) continue;
      H_.block(a.row, b.row, a.size, b.size) += slope * (J(i).transpose() * J(j));
    }
    gradient_.segment(a.row, a.size) += slope * (J(i).transpose() * r.head(num_residuals));
    diagonal_.segment(a.row, a.size) += slope * J(i).colwise().squaredNorm().transpose();
  }
}

void WindowProblem::add_prior(Landmark& landmark, const Eigen::Vector2d& p_map) {
  const double* at = p_map.data();
  Eigen::Vector2d r;
  Eigen::Matrix<double, 2, 2, Eigen::RowMajor> J;
  double* to = J.data();
  landmark.prior->Evaluate(&at, r.data(), &to);
  const double slope = loss_of(r.squaredNorm(), true, kOutlier_sigma).slope;
  landmark.H += slope * J.transpose() * J;
  landmark.gradient += slope * J.transpose() * r;
}

void WindowProblem::add_landmark(Landmark& landmark, const Eigen::VectorXd& values, double damping,
                                 Evidence evidence) {
  const Eigen::Vector2d p = values.segment<2>(landmark.value);
  landmark.linearised.clear();
  landmark.H.setZero();
  landmark.gradient.setZero();
  if (landmark.prior && evidence == Evidence::kAll) add_prior(landmark, p);
  for (const Observation& o : landmark.observations) {
    const BasePlacement& base = placed_[o.pose];
    LinearisedObservation& seen = landmark.linearised.emplace_back();
    seen.row = blocks_[o.pose].row;
    seen.residual = o.residual.at(base, p);
    const double scale =
        std::sqrt(loss_of(seen.residual.squaredNorm(), true, kOutlier_sigma).slope);
    seen.residual *= scale;
    seen.by_pose = scale * o.residual.by_pose(base, p);
    seen.by_position = scale * o.residual.by_position(base);
    landmark.H += seen.by_position.transpose() * seen.by_position;
    landmark.gradient += seen.by_position.transpose() * seen.residual;
    if (seen.row == kFixed) continue;
    H_.block<3, 3>(seen.row, seen.row) += seen.by_pose.transpose() * seen.by_pose;
    gradient_.segment<3>(seen.row) += seen.by_pose.transpose() * seen.residual;
    diagonal_.segment<3>(seen.row) += seen.by_pose.colwise().squaredNorm().transpose();
  }
  Eigen::Matrix2d damped = landmark.H;
  damped.diagonal() *= 1.0 + damping;
  const Eigen::Matrix2d C = damped.inverse();
  for (const LinearisedObservation& s : landmark.linearised) {
    if (s.row == kFixed) continue;
    const Eigen::Matrix<double, 3, 2> WC = s.by_pose.transpose() * s.by_position * C;
    right_.segment<3>(s.row) -= WC * landmark.gradient;
    for (const LinearisedObservation& t : landmark.linearised) {
      if (t.row == kFixed || t.row > s.row) continue;
      H_.block<3, 3>(s.row, t.row) -= WC * (t.by_position.transpose() * t.by_pose);
    }
  }
}

void WindowProblem::linearise(const Eigen::VectorXd& values, double damping, Evidence evidence) {
  place(values);
  H_.setZero(num_rows_, num_rows_);
  gradient_.setZero(num_rows_);
  diagonal_.setZero(num_rows_);
  right_.setZero(num_rows_);
  for (const Factor& factor : factors_) {
    if (evidence == Evidence::kAll || factor.is_own) add_factor(factor, values);
  }
  for (Landmark& landmark : landmarks_) add_landmark(landmark, values, damping, evidence);
  right_ += gradient_;
  H_.diagonal() += damping * diagonal_;
}

std::optional<LeastSquaresStep> WindowProblem::find_step(const Eigen::VectorXd& values,
                                                         double damping) {
  linearise(values, damping, Evidence::kAll);
  const Eigen::LLT<Eigen::MatrixXd> factor(H_);
  if (factor.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd delta = -factor.solve(right_);
  LeastSquaresStep step;
  step.change.setZero(values.size());
  double slope = gradient_.dot(delta);
  double damped = damping * delta.dot(diagonal_.cwiseProduct(delta));
  for (const Block& block : blocks_) {
    if (block.row == kFixed) continue;
    step.change.segment(block.value, block.size) = delta.segment(block.row, block.size);
  }
  for (const Landmark& landmark : landmarks_) {
    Eigen::Vector2d moved = Eigen::Vector2d::Zero();
    for (const LinearisedObservation& s : landmark.linearised) {
      if (s.row == kFixed) continue;
      moved += s.by_position.transpose() * (s.by_pose * delta.segment<3>(s.row));
    }
    Eigen::Matrix2d H = landmark.H;
    H.diagonal() *= 1.0 + damping;
    const Eigen::Vector2d own = -H.inverse() * (landmark.gradient + moved);
    step.change.segment<2>(landmark.value) = own;
    slope += landmark.gradient.dot(own);
    damped += damping * own.dot(landmark.H.diagonal().cwiseProduct(own));
  }
  step.gain = 0.5 * (damped - slope);
  if (!step.change.allFinite() || !(step.gain > 0.0)) return std::nullopt;
  return step;
}

/// Returns the norm of all unknowns.
double WindowProblem::norm(const Eigen::VectorXd& values) const {
  double sum = values.squaredNorm();
  for (const Block& block : blocks_) {
    if (block.row == kFixed) sum -= values.segment(block.value, block.size).squaredNorm();
  }
  return std::sqrt(std::max(0.0, sum));
}

bool WindowProblem::solve(int iterations_max, double tolerance) {
  values_ =
      Eigen::Map<const Eigen::VectorXd>(start_.data(), static_cast<Eigen::Index>(start_.size()));
  return minimise(
      values_, iterations_max, tolerance,
      [&](const Eigen::VectorXd& values) { return cost(values); },
      [&](const Eigen::VectorXd& values, double damping) { return find_step(values, damping); },
      [&](const Eigen::VectorXd& values) { return norm(values); });
}

Eigen::MatrixXd WindowProblem::information(Evidence evidence) {
  linearise(values_, 0.0, evidence);
  return H_.selfadjointView<Eigen::Lower>();
}

int WindowProblem::pose_row(int keyframe) const { return blocks_[poses_.at(keyframe)].row; }

int WindowProblem::calibration_row(int index) const { return blocks_[calibrations_.at(index)].row; }

bool WindowProblem::write_to(SlamGraph& graph) const {
  for (const auto& [keyframe, block] : poses_) {
    if (!values_.segment<3>(blocks_[block].value).allFinite()) return false;
  }
  for (const auto& [keyframe, block] : poses_) {
    if (blocks_[block].row == kFixed) continue;
    Eigen::Vector3d T = values_.segment<3>(blocks_[block].value);
    T.z() = geometry::wrap_angle_rad(T.z());
    graph.keyframes[keyframe].T_map_base = T;
  }
  for (const auto& [index, block] : calibrations_) {
    graph.calibrations[index] = values_.segment<3>(blocks_[block].value);
  }
  for (const auto& [index, block] : receiver_errors_) {
    graph.receiver_errors[index].p_m = values_.segment<2>(blocks_[block].value);
  }
  for (const Landmark& l : landmarks_) {
    graph.landmarks[l.id].p_map = values_.segment<2>(l.value);
  }
  return true;
}

}  // namespace orchard::pose
