// SPDX-License-Identifier: BSD-3-Clause
// Structure of a whole problem: its unknowns, its factors and the sparsity of its equations.
#include <ceres/cost_function.h>

#include <memory>
#include <utility>

#include "pose/graph/factors.hpp"
#include "pose/graph/full_graph_problem.hpp"

namespace orchard::pose {

void FullGraphProblem::sort_observations() {
  const auto is_observed_twice = [&](int landmark) {
    return graph_.landmarks[static_cast<std::size_t>(landmark)].keyframes.size() >= 2;
  };
  first_observation_.assign(graph_.landmarks.size() + 1, 0);
  for (const Keyframe& k : graph_.keyframes) {
    for (const SlamObservation& o : k.observations) {
      if (is_observed_twice(o.landmark))
        ++first_observation_[static_cast<std::size_t>(o.landmark) + 1];
    }
  }
  for (std::size_t l = 0; l < graph_.landmarks.size(); ++l)
    first_observation_[l + 1] += first_observation_[l];
  observations_.resize(first_observation_.back());
  std::vector<std::size_t> next = first_observation_;
  for (int k = 0; k < num_keyframes(); ++k) {
    for (const SlamObservation& o : graph_.keyframes[k].observations) {
      if (is_observed_twice(o.landmark))
        observations_[next[static_cast<std::size_t>(o.landmark)]++] = {k, &o};
    }
  }
}

void FullGraphProblem::add(ceres::CostFunction* residual, bool is_robust,
                           std::array<int, 3> blocks) {
  Factor factor;
  factor.residual.reset(residual);
  factor.is_robust = is_robust;
  factor.blocks = blocks;
  factors_.push_back(std::move(factor));
}

void FullGraphProblem::add_factors(const SlamConfig& config) {
  const CalibrationPrior prior = CalibrationPrior::initial(config);
  add(calibration_prior_factor(prior.mean, prior.covariance), false, {calibration_block(0)});
  const Eigen::Vector3d kept = calibration_decay(graph_.calibration_walk_sd, config);
  for (int c = 1; c < static_cast<int>(graph_.calibrations.size()); ++c) {
    add(calibration_walk_factor(kept, graph_.calibration_walk_sd), false,
        {calibration_block(c - 1), calibration_block(c)});
  }
  for (int k = 0; k < num_keyframes(); ++k) {
    const Keyframe& keyframe = graph_.keyframes[k];
    if (k > 0) {
      add(motion_factor(keyframe.motion, keyframe.motion.covariance), false,
          {k - 1, k, calibration_block(keyframe.calibration)});
    }
    if (graph_.georeferenced) add_positions(k);
  }
  add_receiver_errors();
  for (const RelativePose& r : graph_.relative_poses) {
    RelativeMotion motion;
    motion.delta = r.T_from_to;
    add(motion_factor(motion, r.covariance), true,
        {r.from, r.to, calibration_block(graph_.keyframes[r.to].calibration)});
  }
}

void FullGraphProblem::add_positions(int keyframe) {
  for (const AbsolutePosition& p : graph_.keyframes[keyframe].positions) {
    if (p.is_displaced) continue;
    if (p.receiver_error >= 0) {
      add(receiver_position_factor(p, graph_.receiver.noise), true,
          {keyframe, receiver_block(p.receiver_error)});
    } else {
      add(absolute_position_factor(p), true, {keyframe});
    }
    if (p.has_yaw) add(heading_factor(p), true, {keyframe});
  }
}

// The loss is robust because the error jumps when reflections of the signal begin or end.
void FullGraphProblem::add_receiver_errors() {
  std::vector<char> is_used(graph_.receiver_errors.size(), 0);
  if (graph_.georeferenced) {
    for (const Keyframe& k : graph_.keyframes) {
      for (const AbsolutePosition& p : k.positions) {
        if (p.receiver_error >= 0) is_used[static_cast<std::size_t>(p.receiver_error)] = 1;
      }
    }
  }
  int before = -1;
  for (int e = 0; e < static_cast<int>(is_used.size()); ++e) {
    if (is_used[e] == 0) continue;
    const ReceiverError& now = graph_.receiver_errors[e];
    if (before < 0) {
      add(receiver_error_prior_factor(graph_.receiver, now), true, {receiver_block(e)});
    } else {
      add(receiver_error_factor(graph_.receiver, graph_.receiver_errors[before], now), true,
          {receiver_block(before), receiver_block(e)});
    }
    before = e;
  }
}

/// Chooses which blocks are unknowns of the equations and which pairs of them are coupled.
void FullGraphProblem::choose_structure() {
  std::vector<char> is_unknown(columns_.size(), 0);
  for (const Factor& factor : factors_) {
    for (std::size_t i = 0; i < factor.residual->parameter_block_sizes().size(); ++i) {
      is_unknown[static_cast<std::size_t>(factor.blocks[i])] = 1;
    }
  }
  for (const LandmarkObservation& seen : observations_)
    is_unknown[static_cast<std::size_t>(seen.keyframe)] = 1;
  if (!graph_.georeferenced) is_unknown[0] = 0;  // the origin is fixed
  std::vector<int> sizes;
  for (int block = 0; block < landmark_block(0); ++block) {
    if (is_unknown[static_cast<std::size_t>(block)] == 0) continue;
    columns_[static_cast<std::size_t>(block)] = static_cast<int>(sizes.size());
    sizes.push_back(value(block + 1) - value(block));
  }
  const auto couple = [this](NormalEquations& equations) {
    for (const Factor& factor : factors_) {
      const std::size_t n = factor.residual->parameter_block_sizes().size();
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
          const int a = columns_[factor.blocks[i]], b = columns_[factor.blocks[j]];
          if (a >= 0 && b >= 0) equations.couple(a, b);
        }
      }
    }
  };
  auto without = std::make_unique<NormalEquations>(sizes);
  couple(*without);
  std::size_t num_with = without->num_entries() + 6 * observations_.size();
  for (int l = 0; l < num_landmarks(); ++l) num_with += is_constrained(l) ? 3 : 0;
  eliminates_ = try_eliminating(*without, num_with);
  if (eliminates_) {
    equations_ = std::move(without);
    equations_->finish();
    return;
  }
  for (int l = 0; l < num_landmarks(); ++l) {
    if (!is_constrained(l)) continue;
    columns_[static_cast<std::size_t>(landmark_block(l))] = static_cast<int>(sizes.size());
    sizes.push_back(2);
  }
  equations_ = std::make_unique<NormalEquations>(sizes);
  couple(*equations_);
  for (int l = 0; l < num_landmarks(); ++l) {
    for (std::size_t s = first_observation_[l]; s < first_observation_[l + 1]; ++s) {
      const int pose = columns_[observations_[s].keyframe];
      if (pose >= 0) equations_->couple(pose, columns_[landmark_block(l)]);
    }
  }
  equations_->finish();
}

/// Couples all poses that observed a common landmark. Gives up and returns false if that needs more
/// coefficients than keeping the landmarks as unknowns: many keyframes in one place.
bool FullGraphProblem::try_eliminating(NormalEquations& without, std::size_t num_with) const {
  std::size_t num_since = 0;
  for (int l = 0; l < num_landmarks(); ++l) {
    const std::size_t num = first_observation_[l + 1] - first_observation_[l];
    if (9 * num * num / 2 > num_with) return false;
    for (std::size_t s = first_observation_[l]; s < first_observation_[l + 1]; ++s) {
      for (std::size_t t = first_observation_[l]; t < s; ++t) {
        const int a = columns_[observations_[s].keyframe], b = columns_[observations_[t].keyframe];
        if (a >= 0 && b >= 0) without.couple(a, b);
      }
    }
    num_since += 9 * num * num / 2;
    if (num_since < num_with) continue;
    num_since = 0;
    if (without.num_entries() > num_with) return false;
  }
  return without.num_entries() <= num_with;
}

}  // namespace orchard::pose
