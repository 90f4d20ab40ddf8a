// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/map_state.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <utility>

#include "mapping/extent/extent.hpp"
#include "mapping/landmark_record.hpp"
#include "mapping/store/observation_store.hpp"

namespace orchard::mapping {
namespace {

/// derived: the floor of 1 mm that compose() adds.
constexpr double kAssociationVarianceMin_m2 = 1e-6;

/// Adds one observation to a record; its aligned position and variance update the association
/// position.
void add_to_record(LandmarkRecord& r, const detection::Detection& d, const Eigen::Vector2d& p_map,
                   const Eigen::Vector2d& p_aligned, double aligned_variance_m2,
                   const MapperConfig& config) {
  fuse_association_position(r, p_aligned,
                            std::max(kAssociationVarianceMin_m2, aligned_variance_m2));
  fuse_width(r, d, config.min_beams);
  accumulate(r, p_map, d.roc_tree, d.label, evidence_of(d, config), log_odds_max(config));
  ++r.num_all;
}

}  // namespace

void MapState::add_observation(std::int32_t index, const Candidate& c) {
  landmarks.change(index, [&](LandmarkRecord& r) {
    add_to_record(r, *c.detection, c.p_map, c.p_aligned, 0.5 * c.aligned_covariance.trace(),
                  config);
    r.last_observation = observations.prepend(observation_of(c), r.last_observation);
    r.last_scan = observations.last_scan();
    r.clearance = std::max(r.clearance, c.clearance);
  });
}

void MapState::merge(std::int32_t keep, std::int32_t drop) {
  const LandmarkRecord dropped = landmarks[drop];
  landmarks.remove(drop);
  modes.forget(keep);
  landmarks.change(keep, [&](LandmarkRecord& kept) {
    mapping::merge(kept, dropped, log_odds_max(config));
    kept.last_observation = observations.join(dropped.last_observation, kept.last_observation);
  });
}

void MapState::renumber(const std::vector<std::int32_t>& kept) {
  LandmarkRecord removed;
  removed.is_removed = true;
  std::int32_t num_indices = 0;
  for (const std::int32_t index : kept) num_indices = std::max(num_indices, index + 1);
  std::vector<LandmarkRecord> records(static_cast<std::size_t>(num_indices), removed);
  for (std::int32_t i = 0; i < landmarks.num_indices(); ++i) {
    const std::int32_t index = kept[static_cast<std::size_t>(i)];
    if (index >= 0) records[static_cast<std::size_t>(index)] = landmarks[i];
  }
  landmarks = LandmarkTable(std::move(records));
}

PositionMode MapState::mode_of(const LandmarkRecord& r) const {
  return position_mode(observations.newest(r.last_observation, kPositionSamplesMax),
                       {r.mean_x_m, r.mean_y_m}, config.centre_kernel_m);
}

Landmark MapState::report(std::int32_t index, const PositionMode& mode) const {
  const LandmarkRecord& r = landmarks[index];
  const Eigen::Vector2d se_m = standard_error_m(r);
  Landmark l;
  l.id = index + 1;
  l.label = label_of(r, config);
  // Nothing but the width of a trunk tells what may be the ground from it.
  const bool may_be_ground = r.clearance == Clearance::kLow;
  if (may_be_ground && l.label == detection::Label::kObject) l.label = detection::Label::kUnseen;
  l.num_observations = r.num_observations;
  const Eigen::Vector2d p_map = r.is_clump ? r.association_position() : mode.p_map;
  l.x_m = p_map.x();
  l.y_m = p_map.y();
  l.se_x_m = se_m.x();
  l.se_y_m = se_m.y();
  l.covariance = {mode.covariance(0, 0), mode.covariance(0, 1), mode.covariance(1, 1)};
  l.width_m = r.width_m;
  l.width_sd_m = width_sd_m(r);
  if (r.is_clump) {
    l.width_m = 2.0 * extent_radius_m(r);
    l.width_sd_m = std::max(l.width_sd_m, l.width_m / std::sqrt(2.0 * r.num_all));
  }
  l.roc_mean = r.roc_sum / r.num_observations;
  l.probability = probability_of_tree(r, config);
  return l;
}

ChunkedArray<std::int32_t> MapState::landmark_of_observation() const {
  ChunkedArray<std::int32_t> landmark_of(observations.memory());
  for (std::int32_t k = 0; k < observations.num_observations(); ++k) landmark_of.push_back(-1);
  for (std::int32_t i = 0; i < landmarks.num_indices(); ++i) {
    if (landmarks[i].is_removed) continue;
    for (std::int32_t k = landmarks[i].last_observation; k >= 0; k = observations[k].previous) {
      landmark_of.edit(static_cast<std::size_t>(k)) = i;
    }
  }
  return landmark_of;
}

std::vector<std::int32_t> MapState::observations_of(std::int32_t index) const {
  std::vector<std::int32_t> all;
  if (landmarks[index].is_removed) return all;
  for (std::int32_t k = landmarks[index].last_observation; k >= 0; k = observations[k].previous) {
    all.push_back(k);
  }
  return all;
}

namespace {

/// derived: Minimum number of judged observations.
constexpr int kJudgedMin = 10;

}  // namespace

LabelConflicts count_label_conflicts(const MapState& map) {
  using detection::Label;
  const TreeRates rates = tree_rates(map.config);
  // `neither`: fraction of TREE labels with no evidence either way. The votes are split when the
  // fraction is nearer to it than to the rates of both classes.
  const double for_tree = std::log(rates.of_trees / rates.of_objects);
  const double for_object = std::log((1.0 - rates.of_objects) / (1.0 - rates.of_trees));
  const double neither = for_object / (for_tree + for_object);
  const double least = 0.5 * (neither + rates.of_objects);
  const double most = 0.5 * (neither + rates.of_trees);
  LabelConflicts votes;
  for (std::int32_t i = 0; i < map.landmarks.num_indices(); ++i) {
    const LandmarkRecord& r = map.landmarks[i];
    if (r.is_removed || r.num_observations < kJudgedMin) continue;
    int num_tree = 0, num_judged = 0;
    for (const std::int32_t k :
         map.observations.newest_of(r.last_observation, kPositionSamplesMax)) {
      const auto label = static_cast<Label>(map.observations[k].label);
      if (label == Label::kUnseen) continue;
      ++num_judged;
      if (label == Label::kTree) ++num_tree;
    }
    if (num_judged < kJudgedMin || num_tree == 0) continue;
    ++votes.num_with_tree_label;
    const double fraction = static_cast<double>(num_tree) / num_judged;
    if (fraction > least && fraction < most) ++votes.num_conflicting;
  }
  return votes;
}

std::vector<std::int32_t> keep_indices(
    const std::function<std::vector<std::int32_t>(std::int32_t now)>& then_of, std::int32_t num_now,
    std::int32_t first_unused) {
  std::vector<char> is_observed(static_cast<std::size_t>(num_now), 0);
  std::vector<std::tuple<std::int64_t, std::int32_t, std::int32_t>> votes;  // -count, then, now
  for (std::int32_t i = 0; i < num_now; ++i) {
    std::vector<std::int32_t> thens = then_of(i);
    is_observed[static_cast<std::size_t>(i)] = thens.empty() ? 0 : 1;
    std::sort(thens.begin(), thens.end());
    for (std::size_t begin = 0; begin < thens.size();) {
      std::size_t end = begin;
      while (end < thens.size() && thens[end] == thens[begin]) ++end;
      if (thens[begin] >= 0) {
        votes.emplace_back(-static_cast<std::int64_t>(end - begin), thens[begin], i);
      }
      begin = end;
    }
  }
  std::sort(votes.begin(), votes.end());

  std::vector<std::int32_t> kept(static_cast<std::size_t>(num_now), -1);
  std::vector<char> is_taken(static_cast<std::size_t>(first_unused), 0);
  for (const auto& [count, then, now] : votes) {
    std::int32_t& index = kept[static_cast<std::size_t>(now)];
    char& taken = is_taken[static_cast<std::size_t>(then)];
    if (index >= 0 || taken != 0) continue;
    index = then;
    taken = 1;
  }
  for (std::size_t now = 0; now < kept.size(); ++now) {
    if (kept[now] < 0 && is_observed[now] != 0) kept[now] = first_unused++;
  }
  return kept;
}

}  // namespace orchard::mapping
