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

/// A landmark with a single observation constrains nothing.
bool is_observed_twice(const SlamGraph& graph, int landmark) {
  return graph.landmarks[static_cast<std::size_t>(landmark)].keyframes.size() >= 2;
}

}  // namespace

template <class Equations>
GraphProblem<Equations>::GraphProblem(const SlamGraph& graph, int first, bool is_small)
    : graph_(graph),
      landmark_at_(graph.landmarks.size(), kNone),
      first_(first),
      is_small_(is_small) {}

template <class Equations>
GraphProblem<Equations>::~GraphProblem() = default;

template <class Equations>
int GraphProblem<Equations>::add_block(const Eigen::VectorXd& value) {
  Block block;
  block.size = static_cast<int>(value.size());
  block.value = static_cast<int>(start_.size());
  start_.insert(start_.end(), value.begin(), value.end());
  blocks_.push_back(block);
  return static_cast<int>(blocks_.size()) - 1;
}

template <class Equations>
int GraphProblem<Equations>::pose(int keyframe) {
  const auto [at, is_new] = poses_.try_emplace(keyframe, 0);
  if (is_new) {
    at->second = add_block(graph_.keyframes[keyframe].T_map_base);
    blocks_[at->second].pose = num_poses_++;
  }
  return at->second;
}

template <class Equations>
int GraphProblem<Equations>::calibration(int index) {
  const auto [at, is_new] = calibrations_.try_emplace(index, 0);
  if (is_new) at->second = add_block(graph_.calibrations[index]);
  return at->second;
}

template <class Equations>
int GraphProblem<Equations>::receiver_error(int index) {
  const auto [at, is_new] = receiver_errors_.try_emplace(index, 0);
  if (is_new) at->second = add_block(graph_.receiver_errors[index].p_m);
  return at->second;
}

template <class Equations>
int GraphProblem<Equations>::landmark(int id) {
  int& at = landmark_at_[id];
  if (at == kNone) {
    at = static_cast<int>(landmarks_.size());
    Landmark& landmark = landmarks_.emplace_back();
    landmark.id = id;
    landmark.block = add_block(graph_.landmarks[id].p_map);
  }
  return at;
}

template <class Equations>
int GraphProblem<Equations>::row_of(const std::map<int, int>& blocks, int index) const {
  const auto at = blocks.find(index);
  if (at == blocks.end() || blocks_[at->second].column == kNone) return kNone;
  return equations_->first(blocks_[at->second].column);
}

template <class Equations>
std::vector<int> GraphProblem<Equations>::set_columns() {
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

template <class Equations>
void GraphProblem<Equations>::add(ceres::CostFunction* residual, bool is_robust, bool is_own,
                                  std::initializer_list<int> blocks) {
  Factor& factor = factors_.emplace_back();
  factor.residual.reset(residual);
  factor.is_robust = is_robust;
  factor.is_own = is_own;
  for (const int block : blocks) factor.blocks[factor.num_blocks++] = block;
}

template <class Equations>
void GraphProblem<Equations>::add_motion(int keyframe, const Eigen::Matrix3d& covariance,
                                         bool is_own) {
  const Keyframe& k = graph_.keyframes[keyframe];
  add(motion_factor(k.motion, covariance), false, is_own,
      {pose(keyframe - 1), pose(keyframe), calibration(k.calibration)});
}

template <class Equations>
void GraphProblem<Equations>::add_relative_pose(const RelativePose& relative, bool is_own) {
  RelativeMotion motion;
  motion.delta = relative.T_from_to;
  add(motion_factor(motion, relative.covariance), true, is_own,
      {pose(relative.from), pose(relative.to),
       calibration(graph_.keyframes[relative.to].calibration)});
}

template <class Equations>
void GraphProblem<Equations>::add_positions(int keyframe) {
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
template <class Equations>
void GraphProblem<Equations>::add_receiver_errors() {
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

template <class Equations>
void GraphProblem<Equations>::add_calibration_prior(int index, const CalibrationPrior& prior) {
  add(calibration_prior_factor(prior.mean, prior.covariance), false, false, {calibration(index)});
}

template <class Equations>
void GraphProblem<Equations>::add_calibration_walk(int index, const Eigen::Vector3d& kept) {
  add(calibration_walk_factor(kept, graph_.calibration_walk_sd), false, true,
      {calibration(index - 1), calibration(index)});
}

/// Computes the rotations of the poses once for all their observations.
template <class Equations>
void GraphProblem<Equations>::place(const Eigen::VectorXd& values) {
  placed_.clear();
  for (const Block& block : blocks_) {  // poses have their numbers in order of their blocks
    if (block.pose != kNone) placed_.emplace_back(values.segment<3>(block.value));
  }
}

template <class Equations>
ObservationResidual GraphProblem<Equations>::residual_of(const Observation& observation) const {
  if (residuals_.empty()) return ObservationResidual(*observation.observation);
  return residuals_[static_cast<std::size_t>(&observation - observations_.data())];
}

template <class Equations>
double GraphProblem<Equations>::cost(const Eigen::VectorXd& values, bool robust) {
  place(values);
  double sum = 0.0;
  for (const Factor& factor : factors_) {
    std::array<const double*, 3> at{};
    for (int i = 0; i < factor.num_blocks; ++i) {
      at[i] = values.data() + blocks_[factor.blocks[i]].value;
    }
    Eigen::Vector3d r = Eigen::Vector3d::Zero();
    factor.residual->Evaluate(at.data(), r.data(), nullptr);
    sum += loss_of(r.squaredNorm(), robust && factor.is_robust, kOutlier_sigma).cost;
  }
  for (const Landmark& landmark : landmarks_) {
    const Eigen::Vector2d p = values.segment<2>(blocks_[landmark.block].value);
    if (landmark.prior) {
      const double* at = p.data();
      Eigen::Vector2d r;
      landmark.prior->Evaluate(&at, r.data(), nullptr);
      sum += loss_of(r.squaredNorm(), true, kOutlier_sigma).cost;
    }
    for (std::size_t s = landmark.first; s < landmark.end; ++s) {
      const Observation& o = observations_[s];
      const Eigen::Vector2d r = residual_of(o).at(placed_[blocks_[o.pose].pose], p);
      sum += loss_of(r.squaredNorm(), robust, kOutlier_sigma).cost;
    }
  }
  return sum;
}

template <class Equations>
void GraphProblem<Equations>::add_factor(const Factor& factor, const Eigen::VectorXd& values,
                                         bool robust) {
  const int num_residuals = factor.residual->num_residuals();
  std::array<const double*, 3> at{};
  std::array<std::array<double, 9>, 3> derivatives{};
  std::array<double*, 3> to{};
  for (int i = 0; i < factor.num_blocks; ++i) {
    at[i] = values.data() + blocks_[factor.blocks[i]].value;
    to[i] = derivatives[i].data();
  }
  Eigen::Vector3d r = Eigen::Vector3d::Zero();
  factor.residual->Evaluate(at.data(), r.data(), to.data());
  const double slope = loss_of(r.squaredNorm(), robust && factor.is_robust, kOutlier_sigma).slope;
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

template <class Equations>
void GraphProblem<Equations>::linearise_observations(const Observation* begin,
                                                     const Observation* end,
                                                     const Eigen::Vector2d& p_map, bool robust,
                                                     Linearised& out) const {
  out.clear();
  for (const Observation* o = begin; o != end; ++o) {
    const ObservationResidual residual = residual_of(*o);
    const BasePlacement& base = placed_[blocks_[o->pose].pose];
    LinearisedObservation& seen = out.emplace_back();
    seen.column = blocks_[o->pose].column;
    seen.residual = residual.at(base, p_map);
    const double scale =
        std::sqrt(loss_of(seen.residual.squaredNorm(), robust, kOutlier_sigma).slope);
    seen.residual *= scale;
    seen.by_pose = scale * residual.by_pose(base, p_map);
    seen.by_position = scale * residual.by_position(base);
  }
}

template <class Equations>
const typename GraphProblem<Equations>::Linearised& GraphProblem<Equations>::linearised(
    std::size_t landmark, const Eigen::VectorXd& values, bool robust) {
  const Landmark& l = landmarks_[landmark];
  Linearised& out = is_small_ ? kept_[landmark] : scratch_;
  linearise_observations(observations_.data() + l.first, observations_.data() + l.end,
                         values.segment<2>(blocks_[l.block].value), robust, out);
  return out;
}

template <class Equations>
typename GraphProblem<Equations>::Position GraphProblem<Equations>::position_of(
    const Landmark& landmark, const Linearised& observations, const Eigen::VectorXd& values,
    Evidence evidence) const {
  Position position;
  if (landmark.prior && evidence == Evidence::kAll) {
    const double* at = values.data() + blocks_[landmark.block].value;
    Eigen::Vector2d r;
    Eigen::Matrix<double, 2, 2, Eigen::RowMajor> J;
    double* to = J.data();
    landmark.prior->Evaluate(&at, r.data(), &to);
    const double slope = loss_of(r.squaredNorm(), true, kOutlier_sigma).slope;
    position.H += slope * J.transpose() * J;
    position.gradient += slope * J.transpose() * r;
  }
  for (const LinearisedObservation& s : observations) {
    position.H += s.by_position.transpose() * s.by_position;
    position.gradient += s.by_position.transpose() * s.residual;
  }
  return position;
}

template <class Equations>
void GraphProblem<Equations>::add_landmark(std::size_t landmark, const Eigen::VectorXd& values,
                                           bool robust, double damping, Evidence evidence) {
  const Linearised& observations = linearised(landmark, values, robust);
  auto [H, g] = position_of(landmarks_[landmark], observations, values, evidence);
  for (const LinearisedObservation& s : observations) {
    if (s.column == kNone) continue;
    const int first = equations_->first(s.column);
    equations_->add(s.column, s.column, Eigen::Matrix3d(s.by_pose.transpose() * s.by_pose));
    gradient_.template segment<3>(first) += s.by_pose.transpose() * s.residual;
    diagonal_.template segment<3>(first) += s.by_pose.colwise().squaredNorm().transpose();
  }
  const int own = blocks_[landmarks_[landmark].block].column;
  if (own != kNone) {
    equations_->add(own, own, H);
    gradient_.template segment<2>(equations_->first(own)) += g;
    diagonal_.template segment<2>(equations_->first(own)) += H.diagonal();
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
    right_.template segment<3>(equations_->first(s.column)) -= WC * g;
    for (const LinearisedObservation& t : observations) {  // each pair once: lower triangle only
      if (t.column == kNone || t.column > s.column) continue;
      equations_->add(s.column, t.column,
                      Eigen::Matrix3d(-WC * (t.by_position.transpose() * t.by_pose)));
    }
  }
}

template <class Equations>
void GraphProblem<Equations>::linearise(const Eigen::VectorXd& values, bool robust, double damping,
                                        Evidence evidence) {
  place(values);
  equations_->set_zero();
  const int num = equations_->num_unknowns();
  gradient_.setZero(num);
  diagonal_.setZero(num);
  right_.setZero(num);
  for (const Factor& factor : factors_) {
    if (evidence == Evidence::kAll || factor.is_own) add_factor(factor, values, robust);
  }
  for (std::size_t l = 0; l < landmarks_.size(); ++l) {
    add_landmark(l, values, robust, damping, evidence);
  }
  right_ += gradient_;
  for (int i = 0; i < num; ++i) equations_->add_to_diagonal(i, damping * diagonal_[i]);
}

template <class Equations>
std::optional<LeastSquaresStep> GraphProblem<Equations>::find_step(const Eigen::VectorXd& values,
                                                                   bool robust, double damping) {
  linearise(values, robust, damping);
  if (!equations_->factorise()) return std::nullopt;
  const Eigen::VectorXd delta = -equations_->solve(right_);
  LeastSquaresStep step;
  step.change.setZero(values.size());
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
    const Linearised& observations = is_small_ ? kept_[l] : linearised(l, values, robust);
    auto [H, g] = position_of(landmarks_[l], observations, values, Evidence::kAll);
    Eigen::Vector2d moved = Eigen::Vector2d::Zero();
    for (const LinearisedObservation& s : observations) {
      if (s.column == kNone) continue;
      moved += s.by_position.transpose() *
               (s.by_pose * delta.template segment<3>(equations_->first(s.column)));
    }
    const Eigen::Vector2d diagonal = H.diagonal();
    H.diagonal() *= 1.0 + damping;
    const Eigen::Vector2d own = -H.inverse() * (g + moved);
    step.change.template segment<2>(block.value) = own;
    slope += g.dot(own);
    damped += damping * own.dot(diagonal.cwiseProduct(own));
  }
  step.gain = 0.5 * (damped - slope);
  if (!step.change.allFinite() || !(step.gain > 0.0)) return std::nullopt;
  return step;
}

/// Returns the norm of all unknowns.
template <class Equations>
double GraphProblem<Equations>::norm(const Eigen::VectorXd& values) const {
  double sum = 0.0;
  const auto add = [&](const Block& b) { sum += values.segment(b.value, b.size).squaredNorm(); };
  for (const Block& block : blocks_) {
    if (block.column != kNone) add(block);
  }
  for (const Landmark& landmark : landmarks_) {
    if (blocks_[landmark.block].column == kNone) add(blocks_[landmark.block]);
  }
  return std::sqrt(sum);
}

template <class Equations>
bool GraphProblem<Equations>::solve(bool robust, int iterations_max, double tolerance) {
  return minimise(
      values_, iterations_max, tolerance,
      [&](const Eigen::VectorXd& values) { return cost(values, robust); },
      [&](const Eigen::VectorXd& values, double damping) {
        return find_step(values, robust, damping);
      },
      [&](const Eigen::VectorXd& values) { return norm(values); });
}

template <class Equations>
bool GraphProblem<Equations>::write_to(SlamGraph& graph) const {
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

template <class Equations>
void GraphProblem<Equations>::finish() {
  values_ =
      Eigen::Map<const Eigen::VectorXd>(start_.data(), static_cast<Eigen::Index>(start_.size()));
  start_ = {};
  if (!is_small_) return;
  kept_.resize(landmarks_.size());
  for (const Observation& o : observations_) residuals_.emplace_back(*o.observation);
}

template class GraphProblem<DenseEquations>;
template class GraphProblem<NormalEquations>;

void WindowProblem::add_observations(int first, int newest, const std::set<int>& landmarks) {
  GraphProblem::add_observations([&](const auto& visit) {
    for (int k = first; k <= newest; ++k) {
      for (const SlamObservation& o : graph_.keyframes[k].observations) {
        if (landmarks.count(o.landmark) != 0) visit(k, o);
      }
    }
  });
}

void WindowProblem::add_landmark_prior(int landmark, const Eigen::Vector2d& p_map,
                                       const Eigen::Matrix2d& covariance) {
  landmarks_[landmark_at_[landmark]].prior.reset(landmark_prior_factor(p_map, covariance));
}

bool WindowProblem::solve(int iterations_max, double tolerance) {
  finish();
  equations_ = std::make_unique<DenseEquations>(set_columns());
  return GraphProblem::solve(true, iterations_max, tolerance);
}

Eigen::MatrixXd WindowProblem::information(Evidence evidence) {
  linearise(values_, true, 0.0, evidence);
  return equations_->matrix();
}

// Without absolute positions the first keyframe is the origin.
FullGraphProblem::FullGraphProblem(const SlamGraph& graph, const SlamConfig& config)
    : GraphProblem(graph, graph.georeferenced ? 0 : 1, false) {
  add_blocks();
  add_factors(config);
  finish();
  choose_structure();
}

/// Adds all blocks in the order of the equations' unknowns, and the observations.
void FullGraphProblem::add_blocks() {
  const int num_keyframes = static_cast<int>(graph_.keyframes.size());
  for (int k = 0; k < num_keyframes; ++k) pose(k);
  for (std::size_t c = 0; c < graph_.calibrations.size(); ++c) calibration(static_cast<int>(c));
  std::vector<char> has_fix(graph_.receiver_errors.size(), 0);
  std::vector<char> is_observed(graph_.landmarks.size(), 0);
  for (const Keyframe& k : graph_.keyframes) {
    for (const AbsolutePosition& p : k.positions) {
      if (p.receiver_error >= 0) has_fix[static_cast<std::size_t>(p.receiver_error)] = 1;
    }
    for (const SlamObservation& o : k.observations) {
      is_observed[static_cast<std::size_t>(o.landmark)] = 1;
    }
  }
  for (std::size_t e = 0; e < has_fix.size(); ++e) {
    if (graph_.georeferenced && has_fix[e] != 0) receiver_error(static_cast<int>(e));
  }
  for (int l = 0; l < static_cast<int>(is_observed.size()); ++l) {
    if (is_observed[static_cast<std::size_t>(l)] != 0 && is_observed_twice(graph_, l)) landmark(l);
  }
  add_observations([&](const auto& visit) {
    for (int k = 0; k < num_keyframes; ++k) {
      for (const SlamObservation& o : graph_.keyframes[k].observations) {
        if (is_observed_twice(graph_, o.landmark)) visit(k, o);
      }
    }
  });
}

void FullGraphProblem::add_factors(const SlamConfig& config) {
  add_calibration_prior(0, CalibrationPrior::initial(config));
  const Eigen::Vector3d kept = calibration_decay(graph_.calibration_walk_sd, config);
  for (int c = 1; c < static_cast<int>(graph_.calibrations.size()); ++c) {
    add_calibration_walk(c, kept);
  }
  for (int k = 0; k < static_cast<int>(graph_.keyframes.size()); ++k) {
    if (k > 0) add_motion(k, graph_.keyframes[k].motion.covariance, true);
    add_positions(k);
  }
  add_receiver_errors();
  for (const RelativePose& r : graph_.relative_poses) add_relative_pose(r, true);
}

void FullGraphProblem::couple_factors(NormalEquations& equations) const {
  for (const Factor& factor : factors_) {
    for (int i = 0; i < factor.num_blocks; ++i) {
      for (int j = 0; j < i; ++j) {
        const int a = blocks_[factor.blocks[i]].column, b = blocks_[factor.blocks[j]].column;
        if (a != kNone && b != kNone) equations.couple(a, b);
      }
    }
  }
}

/// Chooses which blocks are unknowns of the equations and which pairs of them are coupled.
void FullGraphProblem::choose_structure() {
  std::vector<int> sizes = set_columns();
  auto without = std::make_unique<NormalEquations>(sizes);
  couple_factors(*without);
  const std::size_t num_with =
      without->num_entries() + 6 * observations_.size() + 3 * landmarks_.size();
  if (try_eliminating(*without, num_with)) {
    equations_ = std::move(without);
    equations_->finish();
    return;
  }
  for (const Landmark& l : landmarks_) {
    blocks_[l.block].column = static_cast<int>(sizes.size());
    sizes.push_back(2);
  }
  equations_ = std::make_unique<NormalEquations>(sizes);
  couple_factors(*equations_);
  for (const Landmark& l : landmarks_) {
    for (std::size_t s = l.first; s < l.end; ++s) {
      const int pose = blocks_[observations_[s].pose].column;
      if (pose != kNone) equations_->couple(pose, blocks_[l.block].column);
    }
  }
  equations_->finish();
}

/// Couples all poses that observed a common landmark. Gives up and returns false if that needs more
/// coefficients than keeping the landmarks as unknowns: many keyframes in one place.
bool FullGraphProblem::try_eliminating(NormalEquations& without, std::size_t num_with) const {
  std::size_t num_since = 0;
  for (const Landmark& l : landmarks_) {
    const std::size_t num = l.end - l.first;
    if (9 * num * num / 2 > num_with) return false;
    for (std::size_t s = l.first; s < l.end; ++s) {
      for (std::size_t t = l.first; t < s; ++t) {
        const int a = blocks_[observations_[s].pose].column;
        const int b = blocks_[observations_[t].pose].column;
        if (a != kNone && b != kNone) without.couple(a, b);
      }
    }
    num_since += 9 * num * num / 2;
    if (num_since < num_with) continue;
    num_since = 0;
    if (without.num_entries() > num_with) return false;
  }
  return without.num_entries() <= num_with;
}

bool FullGraphProblem::write_to(SlamGraph& graph) const {
  if (!GraphProblem::write_to(graph)) return false;
  graph.older.forget();
  return true;
}

bool FullGraphProblem::factorise() {
  linearise(values_, true, 0.0);
  return equations_->factorise();
}

void FullGraphProblem::add_position(int landmark, double sign,
                                    Eigen::Matrix<double, Eigen::Dynamic, 2>& by_unknowns,
                                    Eigen::Matrix2d& own) {
  const int at = landmark_at_[static_cast<std::size_t>(landmark)];
  const int column = at == kNone ? kNone : blocks_[landmarks_[at].block].column;
  if (column != kNone) {
    by_unknowns.middleRows<2>(equations_->first(column)) += sign * Eigen::Matrix2d::Identity();
    return;
  }
  // An eliminated landmark lies where its observations put it, given the poses.
  std::vector<Observation> alone;
  if (at == kNone) {  // observed once, so that it determines no pose
    for (const int k : graph_.landmarks[landmark].keyframes) {
      for (const SlamObservation& o : graph_.keyframes[k].observations) {
        if (o.landmark == landmark) alone.push_back({pose(k), &o});
      }
    }
  }
  const Observation* begin = at == kNone ? alone.data() : &observations_[landmarks_[at].first];
  const std::size_t num = at == kNone ? alone.size() : landmarks_[at].end - landmarks_[at].first;
  const Eigen::Vector2d p_map =
      at == kNone ? graph_.landmarks[landmark].p_map
                  : Eigen::Vector2d(values_.segment<2>(blocks_[landmarks_[at].block].value));
  Linearised observations;
  linearise_observations(begin, begin + num, p_map, true, observations);
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  for (const LinearisedObservation& s : observations) {
    H += s.by_position.transpose() * s.by_position;
  }
  const Eigen::Matrix2d C = H.inverse();
  own += C;
  for (const LinearisedObservation& s : observations) {
    if (s.column == kNone) continue;
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

}  // namespace orchard::pose
