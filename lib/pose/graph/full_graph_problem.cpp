// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/full_graph_problem.hpp"

#include <Eigen/LU>
#include <memory>
#include <utility>

namespace orchard::pose {
namespace {

/// A landmark with a single observation constrains nothing.
bool is_observed_twice(const SlamGraph& graph, int landmark) {
  return graph.landmarks[static_cast<std::size_t>(landmark)].keyframes.size() >= 2;
}

}  // namespace

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
