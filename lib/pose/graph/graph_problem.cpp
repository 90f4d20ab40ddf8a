// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/graph_problem.hpp"

#include <ceres/ceres.h>

#include <algorithm>

#include "geometry/pose2.hpp"
#include "pose/graph/factors.hpp"

namespace orchard::pose {
namespace {

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.disable_all_safety_checks = true;
  return options;
}

}  // namespace

Eigen::Vector3d& Unknowns::pose(int keyframe) {
  return poses_.try_emplace(keyframe, graph_.keyframes[keyframe].T_map_base).first->second;
}

Eigen::Vector2d& Unknowns::position(int landmark) {
  return positions_.try_emplace(landmark, graph_.landmarks[landmark].p_map).first->second;
}

OdometryCalibration& Unknowns::calibration(int index) {
  return calibrations_.try_emplace(index, graph_.calibrations[index]).first->second;
}

Eigen::Vector2d& Unknowns::receiver_error(int index) {
  return receiver_errors_.try_emplace(index, graph_.receiver_errors[index].p_m).first->second;
}

void Unknowns::wrap_yaws() {
  for (auto& [k, pose] : poses_) pose.z() = geometry::wrap_angle_rad(pose.z());
}

bool Unknowns::poses_are_finite() const {
  return std::all_of(poses_.begin(), poses_.end(),
                     [](const auto& pose) { return pose.second.allFinite(); });
}

void Unknowns::write_to(SlamGraph& graph) const {
  for (const auto& [k, pose] : poses_) graph.keyframes[k].T_map_base = pose;
  for (const auto& [l, position] : positions_) graph.landmarks[l].p_map = position;
  for (const auto& [c, calibration] : calibrations_) graph.calibrations[c] = calibration;
  for (const auto& [e, p_m] : receiver_errors_) graph.receiver_errors[e].p_m = p_m;
}

GraphProblem::GraphProblem(const SlamGraph& graph, Unknowns& unknowns, bool robust)
    : graph_(graph), unknowns_(unknowns), robust_(robust), problem_(problem_options()) {}

ceres::LossFunction* GraphProblem::loss() const {
  return robust_ ? new ceres::CauchyLoss(kOutlier_sigma) : nullptr;
}

void GraphProblem::add_motion(int keyframe, const Eigen::Matrix3d& covariance, bool is_own) {
  const Keyframe& k = graph_.keyframes[keyframe];
  const ceres::ResidualBlockId id =
      problem_.AddResidualBlock(motion_factor(k.motion, covariance), nullptr, pose(keyframe - 1),
                                pose(keyframe), calibration(k.calibration));
  if (is_own) measurements_.push_back(id);
}

void GraphProblem::add_relative_pose(const RelativePose& relative, bool is_own) {
  RelativeMotion motion;
  motion.delta = relative.T_from_to;
  const ceres::ResidualBlockId id = problem_.AddResidualBlock(
      motion_factor(motion, relative.covariance), loss(), pose(relative.from), pose(relative.to),
      calibration(graph_.keyframes[relative.to].calibration));
  if (is_own) measurements_.push_back(id);
}

void GraphProblem::add_observation(int keyframe, const SlamObservation& observation) {
  measurements_.push_back(problem_.AddResidualBlock(
      observation_factor(observation), loss(), pose(keyframe), position(observation.landmark)));
}

void GraphProblem::add_positions(int keyframe) {
  if (!graph_.georeferenced) return;
  for (const AbsolutePosition& p : graph_.keyframes[keyframe].positions) {
    if (p.is_displaced) continue;
    if (p.receiver_error >= 0) {
      receiver_errors_.insert(p.receiver_error);
      measurements_.push_back(problem_.AddResidualBlock(
          receiver_position_factor(p, graph_.receiver.noise), loss(), pose(keyframe),
          unknowns_.receiver_error(p.receiver_error).data()));
    } else {
      measurements_.push_back(
          problem_.AddResidualBlock(absolute_position_factor(p), loss(), pose(keyframe)));
    }
    if (!p.has_yaw) continue;
    measurements_.push_back(problem_.AddResidualBlock(heading_factor(p), loss(), pose(keyframe)));
  }
}

// The loss is robust because the error jumps when reflections of the signal begin or end.
void GraphProblem::add_receiver_errors() {
  int before = -1;
  for (const int e : receiver_errors_) {
    const ReceiverError& now = graph_.receiver_errors[e];
    double* const error = unknowns_.receiver_error(e).data();
    if (before < 0) {
      measurements_.push_back(problem_.AddResidualBlock(
          receiver_error_prior_factor(graph_.receiver, now), loss(), error));
    } else {
      measurements_.push_back(problem_.AddResidualBlock(
          receiver_error_factor(graph_.receiver, graph_.receiver_errors[before], now), loss(),
          unknowns_.receiver_error(before).data(), error));
    }
    before = e;
  }
}

std::vector<double*> GraphProblem::receiver_errors() {
  std::vector<double*> errors;
  for (const int e : receiver_errors_) errors.push_back(unknowns_.receiver_error(e).data());
  return errors;
}

void GraphProblem::add_landmark_prior(int landmark, const Eigen::Vector2d& p_map,
                                      const Eigen::Matrix2d& covariance) {
  problem_.AddResidualBlock(landmark_prior_factor(p_map, covariance), loss(), position(landmark));
}

void GraphProblem::add_calibration_prior(int index, const CalibrationPrior& prior) {
  problem_.AddResidualBlock(calibration_prior_factor(prior.mean, prior.covariance), nullptr,
                            calibration(index));
}

void GraphProblem::add_calibration_walk(int index, const Eigen::Vector3d& kept) {
  measurements_.push_back(
      problem_.AddResidualBlock(calibration_walk_factor(kept, graph_.calibration_walk_sd), nullptr,
                                calibration(index - 1), calibration(index)));
}

void GraphProblem::fix_pose(int keyframe) {
  problem_.AddParameterBlock(pose(keyframe), 3);
  problem_.SetParameterBlockConstant(pose(keyframe));
}

// Does not use Ceres' Schur complement: it orders blocks by address, so results would differ in
// their last digits from run to run.
bool GraphProblem::solve(ceres::LinearSolverType type, int iterations_max, double tolerance) {
  ceres::Solver::Options options;
  options.linear_solver_type = type;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.dense_linear_algebra_library_type = ceres::EIGEN;
  options.num_threads = 1;
  options.max_num_iterations = iterations_max;
  options.function_tolerance = tolerance;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  return summary.IsSolutionUsable();
}

ceres::CRSMatrix GraphProblem::jacobian(const std::vector<double*>& blocks) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = blocks;
  ceres::CRSMatrix J;
  problem_.Evaluate(options, nullptr, nullptr, nullptr, &J);
  return J;
}

std::vector<char> GraphProblem::measured_rows() const {
  std::vector<ceres::ResidualBlockId> all;
  problem_.GetResidualBlocks(&all);
  std::vector<char> is_measured;
  auto measurement = measurements_.begin();  // both in the order in which they were added
  for (const ceres::ResidualBlockId& id : all) {
    const bool is_one = measurement != measurements_.end() && *measurement == id;
    if (is_one) ++measurement;
    const int num_rows = problem_.GetCostFunctionForResidualBlock(id)->num_residuals();
    is_measured.insert(is_measured.end(), static_cast<std::size_t>(num_rows), is_one ? 1 : 0);
  }
  return is_measured;
}

}  // namespace orchard::pose
