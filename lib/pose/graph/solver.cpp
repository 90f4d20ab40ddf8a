// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/solver.hpp"

#include <ceres/cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "geometry/pose2.hpp"
#include "pose/graph/georeference.hpp"
#include "pose/graph/graph_problem.hpp"
#include "pose/graph/normal_equations.hpp"
#include "pose/graph/observation_noise.hpp"

namespace orchard::pose {
using geometry::compose_jacobian_first;
using geometry::compose_jacobian_second;

namespace {

// derived: limits of iterations and the relative decrease of the cost below which they end. Each
// keyframe is solved in many successive windows, so a single one need not converge; across gaps
// between positions without landmarks convergence is slow.
constexpr int kWindowIterations = 6;
constexpr double kWindowTolerance = 1e-4;
constexpr int kGraphIterations = 30;
constexpr int kClosureIterations = 10;
constexpr int kBendIterations = 100;
constexpr double kGraphTolerance = 1e-6;

/// A landmark with a single observation constrains nothing.
bool is_constrained(const SlamLandmark& landmark) { return landmark.keyframes.size() >= 2; }

/// Problem of the last keyframes of a graph; the equations of the few poses are dense.
/// Observations, absolute positions and priors on landmarks have a robust loss (Cauchy).
class WindowProblem : public GraphProblem {
 public:
  /// `first`: the first keyframe of the window; the poses of earlier ones are fixed.
  WindowProblem(const SlamGraph& graph, int first) : GraphProblem(graph, first, true) {}

  /// Adds the observations of these landmarks from the first to the newest keyframe; call it once.
  void add_observations(int first, int newest, const std::set<int>& landmarks) {
    GraphProblem::add_observations([&](const auto& visit) {
      for (int k = first; k <= newest; ++k) {
        for (const SlamObservation& o : graph_.keyframes[k].observations) {
          if (landmarks.count(o.landmark) != 0) visit(k, o);
        }
      }
    });
  }

  /// Adds a prior on a landmark that was observed.
  void add_landmark_prior(int landmark, const Eigen::Vector2d& p_map,
                          const Eigen::Matrix2d& covariance) {
    landmarks_[landmark_at_[landmark]].prior.reset(landmark_prior_factor(p_map, covariance));
  }

  /// Solves the problem, to which nothing may be added afterwards; returns false if it failed.
  bool solve(int iterations_max, double tolerance) {
    finish();
    equations_ = std::make_unique<NormalEquations>(set_columns(), NormalEquations::Storage::kDense);
    return GraphProblem::solve(true, iterations_max, tolerance);
  }

  using GraphProblem::Evidence;
  /// Returns the information of poses, calibrations and receiver errors at the present values, with
  /// the landmarks marginalised: by all factors, or by the problem's own measurements alone.
  Eigen::MatrixXd information(Evidence evidence) {
    linearise(true, 0.0, evidence);
    return equations_->matrix();
  }
};

/// Problem of a whole graph, with little memory for long drives: landmarks are eliminated if that
/// gives fewer coefficients than keeping them.
class FullGraphProblem : public GraphProblem {
 public:
  // Without absolute positions the first keyframe is the origin.
  FullGraphProblem(const SlamGraph& graph, const SlamConfig& config)
      : GraphProblem(graph, graph.georeferenced ? 0 : 1, false) {
    add_blocks();
    add_factors(config);
    finish();
    choose_structure();
  }

  using GraphProblem::solve;

  /// Number of multiplications that the factorisation of each iteration takes.
  double factor_work() { return equations_->factor_work(); }

  /// As GraphProblem's, and makes the graph forget its sums of older observations.
  bool write_to(SlamGraph& graph) const {
    if (!GraphProblem::write_to(graph)) return false;
    graph.older.forget();
    return true;
  }

  /// Returns the variance of the observations over what they claim, by their scatter at the
  /// solution.
  double observation_noise() const {
    ObservationScatter scatter;
    std::vector<PlacedObservation> placed;
    for (const Landmark& l : landmarks_) {
      placed.clear();
      for (std::size_t s = l.first; s < l.end; ++s) {
        const Block& pose = blocks_[observations_[s].pose];  // has the number of its keyframe
        const BasePlacement base(values_.segment<3>(pose.value));
        const SlamObservation& o = *observations_[s].observation;
        PlacedObservation& one = placed.emplace_back();
        one.travel_m = graph_.keyframes[pose.pose].travel_m;
        one.position.information =
            base.R_base_map.transpose() * o.covariance().inverse() * base.R_base_map;
        one.position.information_m =
            one.position.information * (base.p_map + base.R_base_map.transpose() * o.position());
      }
      scatter.add(placed, graph_.landmarks[l.id].seen_m);
    }
    return scatter.noise();
  }

  /// Returns the covariances at the solution of solve(true); none if the information is singular.
  /// Consumes the equations, so no solve may follow.
  std::optional<SelectedInverse> covariances() {
    if (!factorise()) return std::nullopt;
    return std::move(*equations_).inverse();
  }

  /// Factorises the equations at the present values, for relative_covariance(); returns false if
  /// the information is singular.
  bool factorise() {
    linearise(true, 0.0);
    return equations_->factorise();
  }

  /// Returns the covariance of the position of landmark `b` minus that of `a`, both observed at
  /// least once; call after factorise().
  Eigen::Matrix2d relative_covariance(int a, int b) {
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

 private:
  /// Adds all blocks in the order of the equations' unknowns, and the observations.
  void add_blocks() {
    const int num_keyframes = static_cast<int>(graph_.keyframes.size());
    for (int k = 0; k < num_keyframes; ++k) pose(k);
    for (std::size_t c = 0; c < graph_.calibrations.size(); ++c) calibration(static_cast<int>(c));
    std::vector<char> has_fix(graph_.receiver_errors.size(), 0);
    std::vector<char> is_observed(graph_.landmarks.size(), 0);
    for (const Keyframe& k : graph_.keyframes) {
      for (const AbsolutePosition& p : k.positions) {
        if (p.receiver_error >= 0) has_fix[p.receiver_error] = 1;
      }
      for (const SlamObservation& o : k.observations) {
        is_observed[o.landmark] = 1;
      }
    }
    for (std::size_t e = 0; e < has_fix.size(); ++e) {
      if (graph_.georeferenced && has_fix[e] != 0) receiver_error(static_cast<int>(e));
    }
    for (int l = 0; l < static_cast<int>(is_observed.size()); ++l) {
      if (is_observed[l] != 0 && is_constrained(graph_.landmarks[l])) landmark(l);
    }
    add_observations([&](const auto& visit) {
      for (int k = 0; k < num_keyframes; ++k) {
        for (const SlamObservation& o : graph_.keyframes[k].observations) {
          if (is_constrained(graph_.landmarks[o.landmark])) visit(k, o);
        }
      }
    });
  }

  void add_factors(const SlamConfig& config) {
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

  void couple_factors(NormalEquations& equations) const {
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
  void choose_structure() {
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

  /// Couples all poses that observed a common landmark. Gives up and returns false if that needs
  /// more coefficients than keeping the landmarks as unknowns: many keyframes in one place.
  bool try_eliminating(NormalEquations& without, std::size_t num_with) const {
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

  /// Adds `sign` times a landmark's position to a difference of positions, given as its derivative
  /// by the equations' unknowns and the covariance of what they do not determine.
  void add_position(int landmark, double sign,
                    Eigen::Matrix<double, Eigen::Dynamic, 2>& by_unknowns, Eigen::Matrix2d& own) {
    const int at = landmark_at_[landmark];
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
};

/// Returns the number of entries that the observations take in the matrix of the whole graph, if
/// landmarks stay unknowns: six each, of a position by a pose.
std::size_t num_coupled_entries(const SlamGraph& graph) {
  std::size_t num = 0;
  for (const Keyframe& k : graph.keyframes) num += 6 * k.observations.size();
  return num;
}

/// Returns the covariance of three unknowns from `first` on; none if the information is singular.
std::optional<Eigen::Matrix3d> marginal(const Eigen::MatrixXd& H, int first) {
  const Eigen::LLT<Eigen::MatrixXd> factor(H);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(H.rows(), 3);
  unit.middleRows<3>(first).setIdentity();
  const Eigen::Matrix3d P = factor.solve(unit).middleRows<3>(first);
  if (!P.allFinite()) return std::nullopt;
  return Eigen::Matrix3d(0.5 * (P + P.transpose()));
}

/// The unknowns of a window and its fixed keyframe.
struct Window {
  int fixed = 0;  ///< keyframe before the first
  int first = 1;
  int newest = 1;
  int first_calibration = 0;
  int newest_calibration = 0;
  std::set<int> landmarks;
};

Window window_of(const SlamGraph& graph, int first) {
  Window w;
  w.newest = static_cast<int>(graph.keyframes.size()) - 1;
  w.fixed = std::max(first - 1, 0);
  w.first = w.fixed + 1;
  w.first_calibration = graph.keyframes[w.first].calibration;
  w.newest_calibration = graph.keyframes[w.newest].calibration;
  for (int k = w.first; k <= w.newest; ++k) {
    for (const SlamObservation& o : graph.keyframes[k].observations) {
      if (is_constrained(graph.landmarks[o.landmark])) w.landmarks.insert(o.landmark);
    }
  }
  return w;
}

/// Adds the observations of a landmark by keyframes before the window, their poses fixed, as one
/// prior on its position.
void add_older_observations(const PositionSum& older, int landmark, WindowProblem& problem) {
  if (older.information.determinant() <= 0.0) return;
  const Eigen::Matrix2d covariance = older.information.inverse();
  problem.add_landmark_prior(landmark, covariance * older.information_m, covariance);
}

void add_window(SlamGraph& graph, const Window& w, const CalibrationPrior& prior,
                const SlamConfig& config, WindowProblem& problem) {
  problem.add_calibration_prior(w.first_calibration, prior);
  const Eigen::Vector3d kept = calibration_decay(graph.calibration_walk_sd, config);
  for (int c = w.first_calibration + 1; c <= w.newest_calibration; ++c) {
    problem.add_calibration_walk(c, kept);
  }
  // The fixed keyframe is itself uncertain: add its local covariance to the first motion factor.
  const Keyframe& fixed = graph.keyframes[w.fixed];
  const Eigen::Matrix3d F =
      compose_jacobian_first(Eigen::Vector3d::Zero(), graph.keyframes[w.first].motion.delta);
  const Eigen::Matrix3d back = compose_jacobian_second(fixed.T_map_base).transpose();
  const Eigen::Matrix3d P_base = back * fixed.local_covariance * back.transpose();
  for (int k = w.first; k <= w.newest; ++k) {
    const Keyframe& keyframe = graph.keyframes[k];
    Eigen::Matrix3d Q = keyframe.motion.covariance;
    if (k == w.first) Q += F * P_base * F.transpose();
    problem.add_motion(k, Q, k > w.first);
    problem.add_positions(k);
  }
  problem.add_observations(w.first, w.newest, w.landmarks);
  problem.add_receiver_errors();
  const std::vector<RelativePose>& relative = graph.relative_poses;
  for (auto r = relative.rbegin(); r != relative.rend() && r->to >= w.first; ++r) {
    problem.add_relative_pose(*r, r->from >= w.first);
  }
  graph.older.start(w.first);
  for (const int l : w.landmarks) add_older_observations(graph.older_sum(l), l, problem);
}

/// Computes the covariances of the newest keyframe; `solved` is false if the information is
/// singular.
WindowSolution window_covariances(const Window& w, const Keyframe& first, WindowProblem& problem) {
  const auto row = [&](int keyframe) { return problem.pose_row(keyframe); };
  WindowSolution solution;
  const std::optional<Eigen::Matrix3d> local =
      marginal(problem.information(WindowProblem::Evidence::kAll), row(w.newest));
  if (!local) return solution;
  solution.solved = true;
  solution.local_covariance = *local;
  if (w.newest == w.first) return solution;
  const auto indices = [&](int keyframe, int calibration) {
    const int p = row(keyframe), c = problem.calibration_row(calibration);
    return JointIndices{p, p + 1, p + 2, c, c + 1, c + 2};
  };
  solution.in_map = after_measurements(
      joint_covariance(first), problem.information(WindowProblem::Evidence::kOwnMeasurements),
      indices(w.first, w.first_calibration), indices(w.newest, w.newest_calibration));
  return solution;
}

/// Learns calibration_walk_sd from the steps of the calibration in the solved graph.
void learn_walk(const FullGraphProblem& problem, const SelectedInverse& P, const SlamConfig& config,
                SlamGraph& graph) {
  const Eigen::Vector3d kept = calibration_decay(graph.calibration_walk_sd, config);
  std::vector<CalibrationStep> steps;
  for (int c = 1; c < static_cast<int>(graph.calibrations.size()); ++c) {
    CalibrationStep step;
    step.change = graph.calibrations[c] - kept.cwiseProduct(graph.calibrations[c - 1]);
    for (int i = 0; i < 3; ++i) {
      const int after = problem.calibration_row(c) + i, before = problem.calibration_row(c - 1) + i;
      step.variance[i] = kept[i] * kept[i] * P.at(before, before) + P.at(after, after) -
                         2.0 * kept[i] * P.at(before, after);
    }
    steps.push_back(step);
  }
  graph.calibration_walk_sd = learnt_walk_sd(steps, graph.calibration_walk_sd, config);
}

/// Learns the variance of the receiver's correlated error from the solved graph.
void learn_receiver(const FullGraphProblem& problem, const SelectedInverse& P, SlamGraph& graph) {
  std::vector<double> variances(graph.receiver_errors.size(), -1.0);
  bool is_known = false;
  for (std::size_t e = 0; e < variances.size(); ++e) {
    const int row = problem.receiver_row(static_cast<int>(e));
    if (row < 0) continue;
    variances[e] = 0.5 * (P.at(row, row) + P.at(row + 1, row + 1));
    is_known = true;
  }
  if (!is_known) return;
  graph.receiver.learnt_correlated =
      learnt_receiver_variance(graph, graph.receiver.claimed_correlated, variances);
}

/// Writes the covariances of the poses, the learnt calibration_walk_sd and receiver; returns the
/// covariance of the newest calibration. None, with nothing written, if the information is
/// singular.
std::optional<Eigen::Matrix3d> write_covariances(FullGraphProblem& problem,
                                                 const SlamConfig& config, SlamGraph& graph) {
  const std::optional<SelectedInverse> P = problem.covariances();
  if (!P) return std::nullopt;
  const auto block = [&](int row, int column) {
    Eigen::Matrix3d B;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) B(i, j) = P->at(row + i, column + j);
    }
    return row == column ? Eigen::Matrix3d(0.5 * (B + B.transpose())) : B;
  };
  for (int k = 0; k < static_cast<int>(graph.keyframes.size()); ++k) {
    const int pose = problem.pose_row(k);
    if (pose < 0) continue;  // the origin is fixed
    const int calibration = problem.calibration_row(graph.keyframes[k].calibration);
    JointCovariance joint;
    joint << block(pose, pose), block(pose, calibration), block(pose, calibration).transpose(),
        block(calibration, calibration);
    if (joint.allFinite()) set_joint_covariance(joint, graph.keyframes[k]);
  }
  learn_walk(problem, *P, config, graph);
  learn_receiver(problem, *P, graph);
  const int newest = problem.calibration_row(static_cast<int>(graph.calibrations.size()) - 1);
  return block(newest, newest);
}

}  // namespace

WindowSolution solve_window(SlamGraph& graph, int first, const CalibrationPrior& prior,
                            const SlamConfig& config) {
  if (graph.keyframes.size() < 2) return {};
  const Window window = window_of(graph, first);
  WindowProblem problem(graph, window.first);
  add_window(graph, window, prior, config, problem);
  if (!problem.solve(kWindowIterations, kWindowTolerance)) return {};
  const WindowSolution solution =
      window_covariances(window, graph.keyframes[window.first], problem);
  if (!solution.solved || !problem.write_to(graph)) return {};
  return solution;
}

GraphSolution solve_graph(SlamGraph& graph, bool after_closure, const SlamConfig& config,
                          const SolveLimits& limits) {
  GraphSolution solution;
  if (graph.keyframes.size() < 2) {
    solution.solved = true;
    return solution;
  }
  if (num_coupled_entries(graph) > limits.num_entries) {
    solution.is_beyond_limits = true;
    return solution;
  }
  graph.receiver = estimate_receiver_model(graph);
  FullGraphProblem problem(graph, config);
  if (std::isfinite(limits.factor_work) && problem.factor_work() > limits.factor_work) {
    solution.is_beyond_limits = true;
    return solution;
  }
  if (after_closure) {
    const int iterations = graph.landmarks.empty() ? kBendIterations : kClosureIterations;
    if (!problem.solve(false, iterations, kGraphTolerance)) return solution;
  }
  if (!problem.solve(true, kGraphIterations, kGraphTolerance)) return solution;
  if (!problem.write_to(graph)) return solution;
  solution.solved = true;
  solution.calibration_covariance = write_covariances(problem, config, graph);
  graph.observation_noise = problem.observation_noise();
  return solution;
}

std::optional<std::vector<Eigen::Matrix2d>> relative_covariances(
    const SlamGraph& graph, const std::vector<std::pair<int, int>>& pairs,
    const SlamConfig& config) {
  FullGraphProblem problem(graph, config);
  if (!problem.factorise()) return std::nullopt;
  std::vector<Eigen::Matrix2d> covariances;
  for (const auto& [a, b] : pairs) covariances.push_back(problem.relative_covariance(a, b));
  return covariances;
}

}  // namespace orchard::pose
