// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/graph_problem.hpp"

#include <ceres/cost_function.h>

#include <Eigen/LU>
#include <cmath>
#include <memory>
#include <utility>

#include "geometry/angles.hpp"
#include "pose/graph/normal_equations.hpp"

namespace orchard::pose {
namespace {

/// Cost of a residual, and the factor by which a robust loss scales its square.
struct Loss {
  double cost = 0.0;
  double slope = 1.0;
};

/// Returns half the square or, if `robust`, the Cauchy loss.
Loss loss_of(double square, bool robust) {
  if (!robust) return {0.5 * square, 1.0};
  // derived: squared.
  constexpr double kScale2 = kOutlier_sigma * kOutlier_sigma;
  const double sum = 1.0 + square / kScale2;
  return {0.5 * kScale2 * std::log(sum), 1.0 / sum};
}

}  // namespace

GraphProblem::GraphProblem(const SlamGraph& graph, int first, bool is_small)
    : graph_(graph),
      landmark_at_(graph.landmarks.size(), kNone),
      first_(first),
      is_small_(is_small) {}

GraphProblem::~GraphProblem() = default;

int GraphProblem::add_block(const Eigen::VectorXd& value) {
  Block block;
  block.size = static_cast<int>(value.size());
  block.value = static_cast<int>(start_.size());
  start_.insert(start_.end(), value.begin(), value.end());
  blocks_.push_back(block);
  return static_cast<int>(blocks_.size()) - 1;
}

int GraphProblem::pose(int keyframe) {
  const auto [at, is_new] = poses_.try_emplace(keyframe, 0);
  if (is_new) {
    at->second = add_block(graph_.keyframes[keyframe].T_map_base);
    blocks_[at->second].pose = num_poses_++;
  }
  return at->second;
}

int GraphProblem::calibration(int index) {
  const auto [at, is_new] = calibrations_.try_emplace(index, 0);
  if (is_new) at->second = add_block(graph_.calibrations[index]);
  return at->second;
}

int GraphProblem::receiver_error(int index) {
  const auto [at, is_new] = receiver_errors_.try_emplace(index, 0);
  if (is_new) at->second = add_block(graph_.receiver_errors[index].p_m);
  return at->second;
}

int GraphProblem::landmark(int id) {
  int& at = landmark_at_[id];
  if (at == kNone) {
    at = static_cast<int>(landmarks_.size());
    Landmark& landmark = landmarks_.emplace_back();
    landmark.id = id;
    landmark.block = add_block(graph_.landmarks[id].p_map);
  }
  return at;
}

int GraphProblem::row_of(const std::map<int, int>& blocks, int index) const {
  const auto at = blocks.find(index);
  if (at == blocks.end() || blocks_[at->second].column == kNone) return kNone;
  return equations_->first(blocks_[at->second].column);
}

std::vector<int> GraphProblem::set_columns() {
  std::vector<char> is_eliminated(blocks_.size(), 0);
  for (const Landmark& l : landmarks_) is_eliminated[l.block] = 1;
  for (auto p = poses_.begin(); p != poses_.end() && p->first < first_; ++p) {
    is_eliminated[p->second] = 1;
  }
  std::vector<int> sizes;
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (is_eliminated[b] != 0) continue;
    blocks_[b].column = static_cast<int>(sizes.size());
    sizes.push_back(blocks_[b].size);
  }
  return sizes;
}

void GraphProblem::add(ceres::CostFunction* residual, bool is_robust, bool is_own,
                       std::initializer_list<int> blocks) {
  Factor& factor = factors_.emplace_back();
  factor.residual.reset(residual);
  factor.is_robust = is_robust;
  factor.is_own = is_own;
  for (const int block : blocks) factor.blocks[factor.num_blocks++] = block;
}

void GraphProblem::add_motion(int keyframe, const Eigen::Matrix3d& covariance, bool is_own) {
  const Keyframe& k = graph_.keyframes[keyframe];
  add(motion_factor(k.motion, covariance), false, is_own,
      {pose(keyframe - 1), pose(keyframe), calibration(k.calibration)});
}

void GraphProblem::add_relative_pose(const RelativePose& relative, bool is_own) {
  RelativeMotion motion;
  motion.delta = relative.T_from_to;
  add(motion_factor(motion, relative.covariance), true, is_own,
      {pose(relative.from), pose(relative.to),
       calibration(graph_.keyframes[relative.to].calibration)});
}

void GraphProblem::add_positions(int keyframe) {
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
void GraphProblem::add_receiver_errors() {
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

void GraphProblem::add_calibration_prior(int index, const CalibrationPrior& prior) {
  add(calibration_prior_factor(prior.mean, prior.covariance), false, false, {calibration(index)});
}

void GraphProblem::add_calibration_walk(int index, const Eigen::Vector3d& kept) {
  add(calibration_walk_factor(kept, graph_.calibration_walk_sd), false, true,
      {calibration(index - 1), calibration(index)});
}

/// Computes the rotations of the poses once for all their observations.
void GraphProblem::place(const Eigen::VectorXd& values) {
  placed_.clear();
  for (const Block& block : blocks_) {  // poses have their numbers in order of their blocks
    if (block.pose != kNone) placed_.emplace_back(values.segment<3>(block.value));
  }
}

ObservationResidual GraphProblem::residual_of(const Observation& observation) const {
  if (residuals_.empty())
    return ObservationResidual(*observation.observation, graph_.observation_noise);
  return residuals_[&observation - observations_.data()];
}

double GraphProblem::cost(const Eigen::VectorXd& values, bool robust) {
  place(values);
  double sum = 0.0;
  for (const Factor& factor : factors_) {
    std::array<const double*, 3> at{};
    for (int i = 0; i < factor.num_blocks; ++i) {
      at[i] = values.data() + blocks_[factor.blocks[i]].value;
    }
    Eigen::Vector3d r = Eigen::Vector3d::Zero();
    factor.residual->Evaluate(at.data(), r.data(), nullptr);
    sum += loss_of(r.squaredNorm(), robust && factor.is_robust).cost;
  }
  for (const Landmark& landmark : landmarks_) {
    const Eigen::Vector2d p = values.segment<2>(blocks_[landmark.block].value);
    if (landmark.prior) {
      const double* at = p.data();
      Eigen::Vector2d r;
      landmark.prior->Evaluate(&at, r.data(), nullptr);
      sum += loss_of(r.squaredNorm(), true).cost;
    }
    for (std::size_t s = landmark.first; s < landmark.end; ++s) {
      const Observation& o = observations_[s];
      const Eigen::Vector2d r = residual_of(o).at(placed_[blocks_[o.pose].pose], p);
      sum += loss_of(r.squaredNorm(), robust).cost;
    }
  }
  return sum;
}

void GraphProblem::add_factor(const Factor& factor, bool robust) {
  const int num_residuals = factor.residual->num_residuals();
  std::array<const double*, 3> at{};
  std::array<std::array<double, 9>, 3> derivatives{};
  std::array<double*, 3> to{};
  for (int i = 0; i < factor.num_blocks; ++i) {
    at[i] = values_.data() + blocks_[factor.blocks[i]].value;
    to[i] = derivatives[i].data();
  }
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  factor.residual->Evaluate(at.data(), r.data(), to.data());
  const double slope = loss_of(r.squaredNorm(), robust && factor.is_robust).slope;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
  const auto J = [&](int i) {
    return Eigen::Map<const Rows>(derivatives[i].data(), num_residuals,
                                  blocks_[factor.blocks[i]].size);
  };
  for (int i = 0; i < factor.num_blocks; ++i) {
    const Block& a = blocks_[factor.blocks[i]];
    if (a.column == kNone) continue;
    for (int j = 0; j <= i; ++j) {
      const Block& b = blocks_[factor.blocks[j]];
      if (b.column == kNone) continue;
      equations_->add(a.column, b.column, Rows(slope * (J(i).transpose() * J(j))));
    }
    const int first = equations_->first(a.column);
    gradient_.segment(first, a.size) += slope * (J(i).transpose() * r.head(num_residuals));
    diagonal_.segment(first, a.size) += slope * J(i).colwise().squaredNorm().transpose();
  }
}

void GraphProblem::linearise_observations(const Observation* begin, const Observation* end,
                                          const Eigen::Vector2d& p_map, bool robust,
                                          Linearised& out) const {
  out.clear();
  for (const Observation* o = begin; o != end; ++o) {
    const ObservationResidual residual = residual_of(*o);
    const BasePlacement& base = placed_[blocks_[o->pose].pose];
    LinearisedObservation& seen = out.emplace_back();
    seen.column = blocks_[o->pose].column;
    seen.residual = residual.at(base, p_map);
    const double scale = std::sqrt(loss_of(seen.residual.squaredNorm(), robust).slope);
    seen.residual *= scale;
    seen.by_pose = scale * residual.by_pose(base, p_map);
    seen.by_position = scale * residual.by_position(base);
  }
}

const GraphProblem::Linearised& GraphProblem::linearised(std::size_t landmark, bool robust) {
  const Landmark& l = landmarks_[landmark];
  Linearised& out = is_small_ ? kept_[landmark] : scratch_;
  linearise_observations(observations_.data() + l.first, observations_.data() + l.end,
                         values_.segment<2>(blocks_[l.block].value), robust, out);
  return out;
}

GraphProblem::Position GraphProblem::position_of(const Landmark& landmark,
                                                 const Linearised& observations,
                                                 Evidence evidence) const {
  Position position;
  if (landmark.prior && evidence == Evidence::kAll) {
    const double* at = values_.data() + blocks_[landmark.block].value;
    Eigen::Vector2d r;
    Eigen::Matrix<double, 2, 2, Eigen::RowMajor> J;
    double* to = J.data();
    landmark.prior->Evaluate(&at, r.data(), &to);
    const double slope = loss_of(r.squaredNorm(), true).slope;
    position.H += slope * J.transpose() * J;
    position.gradient += slope * J.transpose() * r;
  }
  for (const LinearisedObservation& s : observations) {
    position.H += s.by_position.transpose() * s.by_position;
    position.gradient += s.by_position.transpose() * s.residual;
  }
  return position;
}

void GraphProblem::add_landmark(std::size_t landmark, bool robust, double damping,
                                Evidence evidence) {
  const Linearised& observations = linearised(landmark, robust);
  auto [H, g] = position_of(landmarks_[landmark], observations, evidence);
  for (const LinearisedObservation& s : observations) {
    if (s.column == kNone) continue;
    const int first = equations_->first(s.column);
    equations_->add(s.column, s.column, Eigen::Matrix3d(s.by_pose.transpose() * s.by_pose));
    gradient_.segment<3>(first) += s.by_pose.transpose() * s.residual;
    diagonal_.segment<3>(first) += s.by_pose.colwise().squaredNorm().transpose();
  }
  const int own = blocks_[landmarks_[landmark].block].column;
  if (own != kNone) {
    equations_->add(own, own, H);
    gradient_.segment<2>(equations_->first(own)) += g;
    diagonal_.segment<2>(equations_->first(own)) += H.diagonal();
    for (const LinearisedObservation& s : observations) {
      if (s.column == kNone) continue;
      equations_->add(own, s.column,
                      Eigen::Matrix<double, 2, 3>(s.by_position.transpose() * s.by_pose));
    }
    return;
  }
  H.diagonal() *= 1.0 + damping;
  const Eigen::Matrix2d C = H.inverse();
  for (const LinearisedObservation& s : observations) {
    if (s.column == kNone) continue;
    const Eigen::Matrix<double, 3, 2> W = s.by_pose.transpose() * s.by_position;
    const Eigen::Matrix<double, 3, 2> WC = W * C;
    right_.segment<3>(equations_->first(s.column)) -= WC * g;
    for (const LinearisedObservation& t : observations) {  // each pair once: lower triangle only
      if (t.column == kNone || t.column > s.column) continue;
      equations_->add(s.column, t.column,
                      Eigen::Matrix3d(-WC * (t.by_position.transpose() * t.by_pose)));
    }
  }
}

void GraphProblem::linearise(bool robust, double damping, Evidence evidence) {
  place(values_);
  equations_->set_zero();
  const int num = equations_->num_unknowns();
  gradient_.setZero(num);
  diagonal_.setZero(num);
  right_.setZero(num);
  for (const Factor& factor : factors_) {
    if (evidence == Evidence::kAll || factor.is_own) add_factor(factor, robust);
  }
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    add_landmark(l, robust, damping, evidence);
  }
  right_ += gradient_;
  for (int i = 0; i < num; ++i) equations_->add_to_diagonal(i, damping * diagonal_[i]);
}

std::optional<GraphProblem::Step> GraphProblem::find_step(bool robust, double damping) {
  linearise(robust, damping);
  if (!equations_->factorise()) return std::nullopt;
  const Eigen::VectorXd delta = -equations_->solve(right_);
  Step step;
  step.change.setZero(values_.size());
  double slope = gradient_.dot(delta);
  double damped = damping * delta.dot(diagonal_.cwiseProduct(delta));
  for (const Block& block : blocks_) {
    if (block.column == kNone) continue;
    step.change.segment(block.value, block.size) =
        delta.segment(equations_->first(block.column), block.size);
  }
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    const Block& block = blocks_[landmarks_[l].block];
    if (block.column != kNone) continue;
    const Linearised& observations = is_small_ ? kept_[l] : linearised(l, robust);
    auto [H, g] = position_of(landmarks_[l], observations, Evidence::kAll);
    Eigen::Vector2d moved = Eigen::Vector2d::Zero();
    for (const LinearisedObservation& s : observations) {
      if (s.column == kNone) continue;
      moved +=
          s.by_position.transpose() * (s.by_pose * delta.segment<3>(equations_->first(s.column)));
    }
    const Eigen::Vector2d diagonal = H.diagonal();
    H.diagonal() *= 1.0 + damping;
    const Eigen::Vector2d own = -H.inverse() * (g + moved);
    step.change.segment<2>(block.value) = own;
    slope += g.dot(own);
    damped += damping * own.dot(diagonal.cwiseProduct(own));
  }
  step.gain = 0.5 * (damped - slope);
  if (!step.change.allFinite() || !(step.gain > 0.0)) return std::nullopt;
  return step;
}

/// Returns the norm of all unknowns.
double GraphProblem::norm_of_unknowns() const {
  double sum = 0.0;
  const auto add = [&](const Block& b) { sum += values_.segment(b.value, b.size).squaredNorm(); };
  for (const Block& block : blocks_) {
    if (block.column != kNone) add(block);
  }
  for (const Landmark& landmark : landmarks_) {
    if (blocks_[landmark.block].column == kNone) add(blocks_[landmark.block]);
  }
  return std::sqrt(sum);
}

bool GraphProblem::solve(bool robust, int iterations_max, double tolerance) {
  // derived: the defaults of Ceres.
  constexpr double kFirstRadius = 1e4;
  constexpr double kRadiusMax = 1e16;
  constexpr double kGainMin = 1e-3;        // min fraction of the predicted decrease of the cost
  constexpr double kStepTolerance = 1e-8;  // relative to the norm of the unknowns
  constexpr int kInvalidStepsMax = 5;      // in a row
  double now = cost(values_, robust);
  if (!std::isfinite(now)) return false;
  double radius = kFirstRadius, shrink = 2.0;
  int num_invalid = 0;
  for (int i = 0; i < iterations_max; ++i) {
    const std::optional<Step> step = find_step(robust, 1.0 / radius);
    if (!step) {
      if (++num_invalid >= kInvalidStepsMax) return false;
      radius /= std::exchange(shrink, 2.0 * shrink);
      continue;
    }
    num_invalid = 0;
    const Eigen::VectorXd there = values_ + step->change;
    const double then = cost(there, robust);
    if (step->change.norm() <= kStepTolerance * (norm_of_unknowns() + kStepTolerance)) return true;
    if (std::abs(now - then) <= tolerance * now) return true;
    const double gained = (now - then) / step->gain;
    if (gained > kGainMin) {  // false if the cost is NaN
      values_ = there;
      now = then;
      radius =
          std::min(kRadiusMax, radius / std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * gained - 1.0, 3)));
      shrink = 2.0;
    } else {
      radius /= std::exchange(shrink, 2.0 * shrink);
    }
  }
  return true;
}

bool GraphProblem::write_to(SlamGraph& graph) const {
  const auto value = [&](int block) { return values_.segment<3>(blocks_[block].value); };
  for (const auto& [keyframe, block] : poses_) {
    if (!value(block).allFinite()) return false;
  }
  for (const auto& [keyframe, block] : poses_) {
    if (keyframe < first_) continue;
    Eigen::Vector3d T = value(block);
    T.z() = geometry::wrap_angle_rad(T.z());
    graph.keyframes[keyframe].T_map_base = T;
  }
  for (const auto& [index, block] : calibrations_) graph.calibrations[index] = value(block);
  for (const auto& [index, block] : receiver_errors_) {
    graph.receiver_errors[index].p_m = values_.segment<2>(blocks_[block].value);
  }
  for (const Landmark& l : landmarks_) {
    graph.landmarks[l.id].p_map = values_.segment<2>(blocks_[l.block].value);
  }
  return true;
}

void GraphProblem::finish() {
  values_ =
      Eigen::Map<const Eigen::VectorXd>(start_.data(), static_cast<Eigen::Index>(start_.size()));
  start_ = {};
  if (!is_small_) return;
  kept_.resize(landmarks_.size());
  for (const Observation& o : observations_) {
    residuals_.emplace_back(*o.observation, graph_.observation_noise);
  }
}

}  // namespace orchard::pose
