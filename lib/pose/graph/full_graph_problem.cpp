// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/full_graph_problem.hpp"

#include <ceres/cost_function.h>

#include <Eigen/LU>
#include <cmath>
#include <utility>

#include "geometry/angles.hpp"
#include "pose/graph/factors.hpp"

namespace orchard::pose {
/// A linearised observation.
struct FullGraphProblem::LinearisedObservation {
  int column = kHasNoColumn;  ///< block of its pose in the equations
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, 3> by_pose;
  Eigen::Matrix2d by_position;
};

FullGraphProblem::FullGraphProblem(const SlamGraph& graph, const SlamConfig& config)
    : graph_(graph) {
  sort_observations();
  const int num_blocks = landmark_block(num_landmarks());
  columns_.assign(static_cast<std::size_t>(num_blocks), kHasNoColumn);
  values_.resize(value(num_blocks));
  for (int k = 0; k < num_keyframes(); ++k) {
    values_.segment<3>(value(k)) = graph.keyframes[k].T_map_base;
  }
  for (std::size_t c = 0; c < graph.calibrations.size(); ++c) {
    values_.segment<3>(value(calibration_block(static_cast<int>(c)))) = graph.calibrations[c];
  }
  for (std::size_t e = 0; e < graph.receiver_errors.size(); ++e) {
    values_.segment<2>(value(receiver_block(static_cast<int>(e)))) = graph.receiver_errors[e].p_m;
  }
  for (int l = 0; l < num_landmarks(); ++l) {
    values_.segment<2>(value(landmark_block(l))) = graph.landmarks[l].p_map;
  }
  add_factors(config);
  choose_structure();
}

FullGraphProblem::~FullGraphProblem() = default;

int FullGraphProblem::value(int block) const {
  const int num_threes = receiver_block(0);
  return block <= num_threes ? 3 * block : 3 * num_threes + 2 * (block - num_threes);
}

bool FullGraphProblem::is_constrained(int landmark) const {
  const auto l = static_cast<std::size_t>(landmark);
  return first_observation_[l + 1] > first_observation_[l];
}

double FullGraphProblem::cost(const Eigen::VectorXd& values, bool robust) const {
  double sum = 0.0;
  for (const Factor& factor : factors_) {
    std::array<const double*, 3> at{};
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = values.data() + value(factor.blocks[i]);
    Eigen::Vector3d r = Eigen::Vector3d::Zero();
    factor.residual->Evaluate(at.data(), r.data(), nullptr);
    sum += loss_of(r.squaredNorm(), robust && factor.is_robust, kOutlier_sigma).cost;
  }
  for (int l = 0; l < num_landmarks(); ++l) {
    const Eigen::Vector2d p = values.segment<2>(value(landmark_block(l)));
    for (std::size_t s = first_observation_[l]; s < first_observation_[l + 1]; ++s) {
      const ObservationResidual residual(*observations_[s].observation);
      const Eigen::Vector2d r =
          residual.at(BasePlacement(values.segment<3>(value(observations_[s].keyframe))), p);
      sum += loss_of(r.squaredNorm(), robust, kOutlier_sigma).cost;
    }
  }
  return sum;
}

void FullGraphProblem::add_factor(const Factor& factor, const Eigen::VectorXd& values,
                                  bool robust) {
  const std::vector<std::int32_t>& sizes = factor.residual->parameter_block_sizes();
  const int n = factor.residual->num_residuals();
  std::array<const double*, 3> at{};
  std::array<std::array<double, 9>, 3> derivatives{};
  std::array<double*, 3> to{};
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    at[i] = values.data() + value(factor.blocks[i]);
    to[i] = derivatives[i].data();
  }
  Eigen::Vector3d all = Eigen::Vector3d::Zero();
  factor.residual->Evaluate(at.data(), all.data(), to.data());
  const double scale =
      std::sqrt(loss_of(all.squaredNorm(), robust && factor.is_robust, kOutlier_sigma).slope);
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
  const auto J = [&](std::size_t i) -> Rows {
    return scale * Eigen::Map<const Rows>(derivatives[i].data(), n, sizes[i]);
  };
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const int a = columns_[factor.blocks[i]];
    if (a < 0) continue;
    const Rows J_a = J(i);
    for (std::size_t j = 0; j <= i; ++j) {
      const int b = columns_[factor.blocks[j]];
      if (b >= 0) equations_->add(a, b, Rows(J_a.transpose() * J(j)));
    }
    const int first = equations_->first(a);
    gradient_.segment(first, sizes[i]) += scale * (J_a.transpose() * all.head(n));
    diagonal_.segment(first, sizes[i]) += J_a.colwise().squaredNorm().transpose();
  }
}

const std::vector<FullGraphProblem::LinearisedObservation>&
FullGraphProblem::linearised_observations(int landmark, const Eigen::VectorXd& values,
                                          bool robust) {
  linearised_.clear();
  const Eigen::Vector2d p = values.segment<2>(value(landmark_block(landmark)));
  const auto add = [&](int keyframe, const SlamObservation& observation) {
    const ObservationResidual residual(observation);
    const BasePlacement T(values.segment<3>(value(keyframe)));
    LinearisedObservation sight;
    sight.column = columns_[keyframe];
    sight.residual = residual.at(T, p);
    const double scale =
        std::sqrt(loss_of(sight.residual.squaredNorm(), robust, kOutlier_sigma).slope);
    sight.residual *= scale;
    sight.by_pose = scale * residual.by_pose(T, p);
    sight.by_position = scale * residual.by_position(T);
    linearised_.push_back(sight);
  };
  for (std::size_t s = first_observation_[landmark]; s < first_observation_[landmark + 1]; ++s) {
    add(observations_[s].keyframe, *observations_[s].observation);
  }
  if (!linearised_.empty()) return linearised_;
  for (const int k : graph_.landmarks[landmark].keyframes) {  // one: it determines no pose
    for (const SlamObservation& o : graph_.keyframes[k].observations) {
      if (o.landmark == landmark) add(k, o);
    }
  }
  return linearised_;
}

void FullGraphProblem::add_landmark(int landmark, const Eigen::VectorXd& values, bool robust,
                                    double damping) {
  const std::vector<LinearisedObservation>& observations =
      linearised_observations(landmark, values, robust);
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  for (const LinearisedObservation& s : observations) {
    H += s.by_position.transpose() * s.by_position;
    g += s.by_position.transpose() * s.residual;
    if (s.column < 0) continue;
    const int first = equations_->first(s.column);
    equations_->add(s.column, s.column, Eigen::Matrix3d(s.by_pose.transpose() * s.by_pose));
    gradient_.segment<3>(first) += s.by_pose.transpose() * s.residual;
    diagonal_.segment<3>(first) += s.by_pose.colwise().squaredNorm().transpose();
  }
  const int own = columns_[landmark_block(landmark)];
  if (own >= 0) {
    equations_->add(own, own, H);
    gradient_.segment<2>(equations_->first(own)) += g;
    diagonal_.segment<2>(equations_->first(own)) += H.diagonal();
    for (const LinearisedObservation& s : observations) {
      if (s.column < 0) continue;
      equations_->add(own, s.column,
                      Eigen::Matrix<double, 2, 3>(s.by_position.transpose() * s.by_pose));
    }
    return;
  }
  H.diagonal() *= 1.0 + damping;
  const Eigen::Matrix2d C = H.inverse();
  for (const LinearisedObservation& s : observations) {
    if (s.column < 0) continue;
    const Eigen::Matrix<double, 3, 2> W = s.by_pose.transpose() * s.by_position;
    const Eigen::Matrix<double, 3, 2> WC = W * C;
    right_.segment<3>(equations_->first(s.column)) -= WC * g;
    for (const LinearisedObservation& t : observations) {  // each pair once: lower triangle only
      if (t.column < 0 || t.column > s.column) continue;
      equations_->add(s.column, t.column,
                      Eigen::Matrix3d(-WC * (t.by_position.transpose() * t.by_pose)));
    }
  }
}

void FullGraphProblem::linearise(const Eigen::VectorXd& values, bool robust, double damping) {
  equations_->set_zero();
  const int num = equations_->num_unknowns();
  gradient_.setZero(num);
  diagonal_.setZero(num);
  right_.setZero(num);
  for (const Factor& factor : factors_) add_factor(factor, values, robust);
  for (int l = 0; l < num_landmarks(); ++l) {
    if (is_constrained(l)) add_landmark(l, values, robust, damping);
  }
  right_ += gradient_;
  for (int i = 0; i < num; ++i) equations_->add_to_diagonal(i, damping * diagonal_[i]);
}

std::optional<LeastSquaresStep> FullGraphProblem::find_step(const Eigen::VectorXd& values,
                                                            bool robust, double damping) {
  linearise(values, robust, damping);
  if (!equations_->factorise()) return std::nullopt;
  const Eigen::VectorXd delta = -equations_->solve(right_);
  LeastSquaresStep step;
  step.change.setZero(values.size());
  double slope = gradient_.dot(delta);
  double damped = damping * delta.dot(diagonal_.cwiseProduct(delta));
  for (int block = 0; block < static_cast<int>(columns_.size()); ++block) {
    const int own = columns_[block];
    if (own < 0) continue;
    step.change.segment(value(block), equations_->size(own)) =
        delta.segment(equations_->first(own), equations_->size(own));
  }
  for (int l = 0; eliminates_ && l < num_landmarks(); ++l) {
    if (!is_constrained(l)) continue;
    Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
    Eigen::Vector2d g = Eigen::Vector2d::Zero(), moved = Eigen::Vector2d::Zero();
    for (const LinearisedObservation& s : linearised_observations(l, values, robust)) {
      H += s.by_position.transpose() * s.by_position;
      g += s.by_position.transpose() * s.residual;
      if (s.column < 0) continue;
      moved +=
          s.by_position.transpose() * (s.by_pose * delta.segment<3>(equations_->first(s.column)));
    }
    const Eigen::Vector2d diagonal = H.diagonal();
    H.diagonal() *= 1.0 + damping;
    const Eigen::Vector2d own = -H.inverse() * (g + moved);
    step.change.segment<2>(value(landmark_block(l))) = own;
    slope += g.dot(own);
    damped += damping * own.dot(diagonal.cwiseProduct(own));
  }
  step.gain = 0.5 * (damped - slope);
  if (!step.change.allFinite() || !(step.gain > 0.0)) return std::nullopt;
  return step;
}

/// Returns the norm of all unknowns.
double FullGraphProblem::norm(const Eigen::VectorXd& values) const {
  double sum = 0.0;
  for (int block = 0; block < static_cast<int>(columns_.size()); ++block) {
    const bool is_unknown = columns_[block] >= 0 || (eliminates_ && block >= landmark_block(0) &&
                                                     is_constrained(block - landmark_block(0)));
    if (!is_unknown) continue;
    sum += values.segment(value(block), value(block + 1) - value(block)).squaredNorm();
  }
  return std::sqrt(sum);
}

bool FullGraphProblem::solve(bool robust, int iterations_max, double tolerance) {
  return minimise(
      values_, iterations_max, tolerance,
      [&](const Eigen::VectorXd& values) { return cost(values, robust); },
      [&](const Eigen::VectorXd& values, double damping) {
        return find_step(values, robust, damping);
      },
      [&](const Eigen::VectorXd& values) { return norm(values); });
}

bool FullGraphProblem::write_to(SlamGraph& graph) const {
  if (!values_.head(value(num_keyframes())).allFinite()) return false;
  graph.older.forget();
  for (int k = 0; k < num_keyframes(); ++k) {
    Eigen::Vector3d T = values_.segment<3>(value(k));
    if (columns_[k] >= 0) T.z() = geometry::wrap_angle_rad(T.z());
    graph.keyframes[k].T_map_base = T;
  }
  for (std::size_t c = 0; c < graph.calibrations.size(); ++c) {
    graph.calibrations[c] = values_.segment<3>(value(calibration_block(static_cast<int>(c))));
  }
  for (std::size_t e = 0; e < graph.receiver_errors.size(); ++e) {
    graph.receiver_errors[e].p_m = values_.segment<2>(value(receiver_block(static_cast<int>(e))));
  }
  for (int l = 0; l < num_landmarks(); ++l) {
    if (is_constrained(l)) {
      graph.landmarks[l].p_map = values_.segment<2>(value(landmark_block(l)));
    }
  }
  return true;
}

bool FullGraphProblem::factorise() {
  linearise(values_, true, 0.0);
  return equations_->factorise();
}

void FullGraphProblem::add_position(int landmark, double sign,
                                    Eigen::Matrix<double, Eigen::Dynamic, 2>& by_unknowns,
                                    Eigen::Matrix2d& own) {
  const int column = columns_[landmark_block(landmark)];
  if (column >= 0) {
    by_unknowns.middleRows<2>(equations_->first(column)) += sign * Eigen::Matrix2d::Identity();
    return;
  }
  // An eliminated landmark lies where its observations put it, given the poses.
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  const std::vector<LinearisedObservation>& observations =
      linearised_observations(landmark, values_, true);
  for (const LinearisedObservation& s : observations) {
    H += s.by_position.transpose() * s.by_position;
  }
  const Eigen::Matrix2d C = H.inverse();
  own += C;
  for (const LinearisedObservation& s : observations) {
    if (s.column < 0) continue;
    by_unknowns.middleRows<3>(equations_->first(s.column)) -=
        sign * (s.by_pose.transpose() * s.by_position * C);
  }
}

Eigen::Matrix2d FullGraphProblem::relative_covariance(int a, int b) {
  Eigen::Matrix<double, Eigen::Dynamic, 2> by_unknowns;
  by_unknowns.setZero(equations_->num_unknowns(), 2);
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();
  add_position(b, 1.0, by_unknowns, P);
  add_position(a, -1.0, by_unknowns, P);
  for (int i = 0; i < 2; ++i) {
    P.col(i) += by_unknowns.transpose() * equations_->solve(by_unknowns.col(i));
  }
  return 0.5 * (P + P.transpose());
}

std::optional<SelectedInverse> FullGraphProblem::covariances() {
  if (!factorise()) return std::nullopt;
  return std::move(*equations_).inverse();
}

int FullGraphProblem::pose_row(int keyframe) const {
  const int own = columns_[keyframe];
  return own < 0 ? -1 : equations_->first(own);
}

int FullGraphProblem::calibration_row(int index) const {
  return equations_->first(columns_[calibration_block(index)]);
}

int FullGraphProblem::receiver_row(int index) const {
  const int own = columns_[receiver_block(index)];
  return own < 0 ? -1 : equations_->first(own);
}

}  // namespace orchard::pose
