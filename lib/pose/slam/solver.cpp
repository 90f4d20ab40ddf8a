// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/solver.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "pose/planar.hpp"
#include "pose/slam/factors.hpp"
#include "pose/slam/selected_inverse.hpp"

namespace orchard::pose {
namespace {

// Every keyframe is in as many windows as one has keyframes: none has to be solved to the end.
constexpr int kWindowIterations = 6;
constexpr double kWindowTolerance = 1e-4;  // share of the sum of squares that a step gains
constexpr double kWholeTolerance = 1e-6;

/// Working copy of the unknowns that a solve may move; the graph sees them on success only.
class Unknowns {
 public:
  explicit Unknowns(const SlamGraph& graph) : graph_(graph) {}

  Eigen::Vector3d& pose(int keyframe) {
    return poses_.try_emplace(keyframe, graph_.keyframes[keyframe].T_map_base).first->second;
  }
  Eigen::Vector2d& place(int landmark) {
    return places_.try_emplace(landmark, graph_.landmarks[landmark].p_map).first->second;
  }
  WheelErrors& errors(int calibration) {
    return errors_.try_emplace(calibration, graph_.calibrations[calibration]).first->second;
  }

  void wrap_yaws() {
    for (auto& [k, pose] : poses_) pose.z() = geometry::wrap_angle_rad(pose.z());
  }
  bool poses_are_finite() const {
    return std::all_of(poses_.begin(), poses_.end(),
                       [](const auto& pose) { return pose.second.allFinite(); });
  }
  void write_to(SlamGraph& graph) const {
    for (const auto& [k, pose] : poses_) graph.keyframes[k].T_map_base = pose;
    for (const auto& [l, place] : places_) graph.landmarks[l].p_map = place;
    for (const auto& [c, errors] : errors_) graph.calibrations[c] = errors;
  }

 private:
  const SlamGraph& graph_;
  std::map<int, Eigen::Vector3d> poses_;
  std::map<int, Eigen::Vector2d> places_;
  std::map<int, WheelErrors> errors_;
};

/// A Ceres problem on a working copy, with its blocks in the order of their making.
class GraphProblem {
 public:
  GraphProblem(const SlamGraph& graph, Unknowns& unknowns, const SlamConfig& config, bool robust)
      : graph_(graph), unknowns_(unknowns), config_(config), robust_(robust), problem_(options()) {}

  void add_motion(int keyframe, const Eigen::Matrix3d& covariance) {
    const Keyframe& k = graph_.keyframes[keyframe];
    keep(problem_.AddResidualBlock(motion_term(k.motion, covariance), nullptr, pose(keyframe - 1),
                                   pose(keyframe), errors(k.calibration)));
  }
  void add_sighting(int keyframe, const SlamSighting& sighting) {
    keep(problem_.AddResidualBlock(sighting_term(sighting), loss(config_.outlier_sigma),
                                   pose(keyframe), place(sighting.landmark)));
  }
  void add_fixes(int keyframe) {
    if (!graph_.placed) return;
    for (const PlaceFix& fix : graph_.keyframes[keyframe].fixes) {
      keep(problem_.AddResidualBlock(fix_term(fix), loss(config_.outlier_sigma), pose(keyframe)));
      if (!fix.has_yaw) continue;
      keep(problem_.AddResidualBlock(heading_term(fix), loss(config_.outlier_sigma),
                                     pose(keyframe)));
    }
  }
  void add_place(int landmark, const Eigen::Vector2d& p_map, const Eigen::Matrix2d& covariance) {
    problem_.AddResidualBlock(place_term(p_map, covariance), loss(config_.outlier_sigma),
                              place(landmark));
  }
  void add_errors_prior(int calibration, const ErrorsPrior& prior) {
    keep(problem_.AddResidualBlock(errors_prior_term(prior.mean, prior.covariance), nullptr,
                                   errors(calibration)));
  }
  void add_errors_walk(int calibration) {
    keep(problem_.AddResidualBlock(
        errors_walk_term(config_.calibration_walk_fraction * initial_errors_sd(config_)), nullptr,
        errors(calibration - 1), errors(calibration)));
  }
  void hold(int keyframe) {
    problem_.AddParameterBlock(pose(keyframe), 3);
    problem_.SetParameterBlockConstant(pose(keyframe));
  }

  // Not by a Schur complement in an order of our own: Ceres keeps that by address, and the digits
  // would change from run to run.
  bool solve(ceres::LinearSolverType type, int iterations, double tolerance) {
    ceres::Solver::Options options;
    options.linear_solver_type = type;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.dense_linear_algebra_library_type = ceres::EIGEN;
    options.num_threads = 1;
    options.max_num_iterations = iterations;
    options.function_tolerance = tolerance;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    return summary.IsSolutionUsable();
  }

  /// Rows of the terms' derivatives, columns as `blocks`. `own` leaves out the places that older
  /// keyframes state.
  ceres::CRSMatrix jacobian(const std::vector<double*>& blocks, bool own) {
    ceres::Problem::EvaluateOptions options;
    options.parameter_blocks = blocks;
    if (own) options.residual_blocks = own_terms_;
    ceres::CRSMatrix J;
    problem_.Evaluate(options, nullptr, nullptr, nullptr, &J);
    return J;
  }

  double* pose(int keyframe) { return unknowns_.pose(keyframe).data(); }
  double* place(int landmark) { return unknowns_.place(landmark).data(); }
  double* errors(int calibration) { return unknowns_.errors(calibration).data(); }

 private:
  static ceres::Problem::Options options() {
    ceres::Problem::Options options;
    options.disable_all_safety_checks = true;
    return options;
  }
  void keep(ceres::ResidualBlockId term) { own_terms_.push_back(term); }
  ceres::LossFunction* loss(double sigma) {
    return robust_ ? new ceres::CauchyLoss(sigma) : nullptr;
  }

  const SlamGraph& graph_;
  Unknowns& unknowns_;
  const SlamConfig& config_;
  bool robust_;
  ceres::Problem problem_;
  std::vector<ceres::ResidualBlockId> own_terms_;
};

/// The window's information, dense: it is small.
Eigen::MatrixXd information(const ceres::CRSMatrix& J) {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(J.num_cols, J.num_cols);
  for (int row = 0; row < J.num_rows; ++row) {
    for (int a = J.rows[row]; a < J.rows[row + 1]; ++a) {
      for (int b = J.rows[row]; b < J.rows[row + 1]; ++b) {
        H(J.cols[a], J.cols[b]) += J.values[a] * J.values[b];
      }
    }
  }
  return H;
}

/// What is left of the information once the places, the unknowns from `num_rest` on, are taken out:
/// none of them has to do with another but through the rest.
Eigen::MatrixXd without_places(const Eigen::MatrixXd& H, int num_rest) {
  const int num_places = static_cast<int>(H.rows()) - num_rest;
  if (num_places == 0) return H;
  Eigen::MatrixXd B = H.topRightCorner(num_rest, num_places);
  for (int place = 0; place < num_places; place += 2) {
    const Eigen::Matrix2d C = H.block<2, 2>(num_rest + place, num_rest + place).inverse();
    const Eigen::Matrix2d root = C.llt().matrixL();
    B.middleCols<2>(place) = (B.middleCols<2>(place) * root).eval();
  }
  Eigen::MatrixXd rest = H.topLeftCorner(num_rest, num_rest);
  rest.selfadjointView<Eigen::Lower>().rankUpdate(B, -1.0);
  return rest;
}

/// Covariance of three of the unknowns; none where the information does not determine them.
std::optional<Eigen::Matrix3d> marginal(const Eigen::MatrixXd& H, int first) {
  const Eigen::LLT<Eigen::MatrixXd> factor(H);
  if (factor.info() != Eigen::Success) return std::nullopt;
  Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(H.rows(), 3);
  unit.middleRows<3>(first).setIdentity();
  const Eigen::Matrix3d P = factor.solve(unit).middleRows<3>(first);
  if (!P.allFinite()) return std::nullopt;
  return Eigen::Matrix3d(0.5 * (P + P.transpose()));
}

/// What older keyframes say of a landmark's place, their poses taken as they are.
std::optional<PlaceFix> place_by_older(const SlamGraph& graph, int landmark, int first) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  Eigen::Vector2d sum_m = Eigen::Vector2d::Zero();
  for (const int k : graph.landmarks[landmark].keyframes) {
    if (k >= first) break;
    const Eigen::Vector3d& T = graph.keyframes[k].T_map_base;
    for (const SlamSighting& s : graph.keyframes[k].sightings) {
      if (s.landmark != landmark) continue;
      const Eigen::Matrix2d R = rotation(T.z());
      const Eigen::Matrix2d W = R * s.covariance().inverse() * R.transpose();
      sum += W;
      sum_m += W * transform(T, s.position());
    }
  }
  if (sum.determinant() <= 0.0) return std::nullopt;
  PlaceFix place;
  place.covariance = sum.inverse();
  place.p_map = place.covariance * sum_m;
  return place;
}

}  // namespace

Eigen::Vector3d initial_errors_sd(const SlamConfig& config) {
  return {config.speed_scale_sd, config.turn_scale_sd, config.yaw_rate_bias_sd_radps};
}

WindowSolution solve_window(SlamGraph& graph, int first, const ErrorsPrior& errors,
                            const SlamConfig& config) {
  const int newest = static_cast<int>(graph.keyframes.size()) - 1;
  WindowSolution solution;
  if (newest < 1) return solution;
  Unknowns unknowns(graph);
  GraphProblem problem(graph, unknowns, config, true);
  const int held = std::max(first - 1, 0);
  first = held + 1;
  std::set<int> seen;
  for (int k = first; k <= newest; ++k) {
    for (const SlamSighting& s : graph.keyframes[k].sightings) {
      if (graph.landmarks[s.landmark].keyframes.size() >= 2) seen.insert(s.landmark);
    }
  }
  const int first_errors = graph.keyframes[first].calibration;
  problem.add_errors_prior(first_errors, errors);
  for (int c = first_errors + 1; c <= graph.keyframes[newest].calibration; ++c) {
    problem.add_errors_walk(c);
  }
  // The held keyframe is not where it is: what it does not know of the map around it goes on.
  const Keyframe& boundary = graph.keyframes[held];
  const Eigen::Matrix3d F =
      compose_jacobian_first(Eigen::Vector3d::Zero(), graph.keyframes[first].motion.delta);
  const Eigen::Matrix3d back = compose_jacobian_second(boundary.T_map_base).transpose();
  const Eigen::Matrix3d P_base = back * boundary.local_covariance * back.transpose();
  for (int k = first; k <= newest; ++k) {
    const Keyframe& keyframe = graph.keyframes[k];
    Eigen::Matrix3d Q = keyframe.motion.covariance;
    if (k == first) Q += F * P_base * F.transpose();
    problem.add_motion(k, Q);
    problem.add_fixes(k);
    for (const SlamSighting& s : keyframe.sightings) {
      if (seen.count(s.landmark) != 0) problem.add_sighting(k, s);
    }
  }
  problem.hold(held);
  for (const int l : seen) {
    const std::optional<PlaceFix> older = place_by_older(graph, l, first);
    if (older) problem.add_place(l, older->p_map, older->covariance);
  }
  if (!problem.solve(seen.empty() ? ceres::DENSE_QR : ceres::SPARSE_NORMAL_CHOLESKY,
                     kWindowIterations, kWindowTolerance) ||
      !unknowns.poses_are_finite()) {
    return solution;
  }

  std::vector<double*> blocks;
  for (int k = first; k <= newest; ++k) blocks.push_back(problem.pose(k));
  const int newest_column = 3 * (newest - first);
  for (int c = first_errors; c <= graph.keyframes[newest].calibration; ++c) {
    blocks.push_back(problem.errors(c));
  }
  const int num_rest = 3 * static_cast<int>(blocks.size());
  for (const int l : seen) blocks.push_back(problem.place(l));
  const std::optional<Eigen::Matrix3d> local = marginal(
      without_places(information(problem.jacobian(blocks, false)), num_rest), newest_column);
  if (!local) return solution;
  solution.local_covariance = *local;
  solution.solved = true;
  if (newest > first) {
    const Eigen::MatrixXd H = without_places(information(problem.jacobian(blocks, true)), num_rest);
    // the first keyframe taken as known
    const std::optional<Eigen::Matrix3d> drift =
        marginal(H.bottomRightCorner(num_rest - 3, num_rest - 3), newest_column - 3);
    const Eigen::Matrix3d to_first = compose_jacobian_second(unknowns.pose(first)).transpose();
    if (drift) solution.drift_covariance = to_first * *drift * to_first.transpose();
  }
  unknowns.wrap_yaws();
  unknowns.write_to(graph);
  return solution;
}

bool solve_whole(SlamGraph& graph, const ErrorsPrior& errors, const WholeSolve& options,
                 const SlamConfig& config, Eigen::Matrix3d* newest_errors_covariance) {
  const int num_keyframes = static_cast<int>(graph.keyframes.size());
  if (num_keyframes < 2) return true;
  Unknowns unknowns(graph);
  std::vector<int> used;
  for (int l = 0; l < static_cast<int>(graph.landmarks.size()); ++l) {
    if (graph.landmarks[l].keyframes.size() >= 2) used.push_back(l);
  }
  std::optional<GraphProblem> problem;
  for (const bool robust : {false, true}) {
    if (!robust && !options.closing) continue;
    problem.emplace(graph, unknowns, config, robust);
    problem->add_errors_prior(0, errors);
    for (std::size_t c = 1; c < graph.calibrations.size(); ++c) problem->add_errors_walk(c);
    for (int k = 0; k < num_keyframes; ++k) {
      if (k > 0) problem->add_motion(k, graph.keyframes[k].motion.covariance);
      problem->add_fixes(k);
      for (const SlamSighting& s : graph.keyframes[k].sightings) {
        if (graph.landmarks[s.landmark].keyframes.size() >= 2) problem->add_sighting(k, s);
      }
    }
    if (!graph.placed) problem->hold(0);
    if (!problem->solve(ceres::SPARSE_NORMAL_CHOLESKY, robust ? 30 : 10, kWholeTolerance)) {
      return false;
    }
  }
  unknowns.wrap_yaws();
  if (!unknowns.poses_are_finite()) return false;
  unknowns.write_to(graph);
  if (!options.covariances) return true;

  std::vector<double*> blocks;
  const int first = graph.placed ? 0 : 1;
  for (int k = first; k < num_keyframes; ++k) blocks.push_back(problem->pose(k));
  for (int c = 0; c < static_cast<int>(graph.calibrations.size()); ++c) {
    blocks.push_back(problem->errors(c));
  }
  for (const int l : used) blocks.push_back(problem->place(l));
  const ceres::CRSMatrix crs = problem->jacobian(blocks, false);
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>> J(
      crs.num_rows, crs.num_cols, static_cast<int>(crs.values.size()), crs.rows.data(),
      crs.cols.data(), crs.values.data());
  const Eigen::SparseMatrix<double> columns = J;
  const Eigen::SparseMatrix<double> H = columns.transpose() * columns;
  const std::optional<Eigen::SparseMatrix<double>> P = selected_inverse(H);
  if (!P) return true;
  const auto block = [&](int column) {
    Eigen::Matrix3d B;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) B(i, j) = P->coeff(column + i, column + j);
    }
    return Eigen::Matrix3d(0.5 * (B + B.transpose()));
  };
  for (int k = first; k < num_keyframes; ++k) {
    const Eigen::Matrix3d B = block(3 * (k - first));
    if (B.allFinite()) graph.keyframes[k].covariance = B;
  }
  if (newest_errors_covariance != nullptr) {
    const int last = static_cast<int>(graph.calibrations.size()) - 1;
    *newest_errors_covariance = block(3 * (num_keyframes - first + last));
  }
  return true;
}

}  // namespace orchard::pose
