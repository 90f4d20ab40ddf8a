// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/window_problem.hpp"

#include <ceres/cost_function.h>

namespace orchard::pose {

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

}  // namespace orchard::pose
