// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/rows.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/angles.hpp"
#include "mapping/rows/row_chains.hpp"
#include "mapping/rows/row_numbers.hpp"
#include "mapping/rows/row_selection.hpp"
#include "mapping/rows/row_tracks.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// derived: How often the regularity of the rows is learnt from the rows that were found with it.
constexpr int kLearningRounds = 3;

using Eigen::Vector2d;

/// The trees sorted by position, so that the result does not depend on the order of the landmarks.
std::vector<const Landmark*> trees_of(const std::vector<Landmark>& landmarks) {
  std::vector<const Landmark*> trees;
  for (const Landmark& l : landmarks) {
    if (l.label == detection::Label::kTree) trees.push_back(&l);
  }
  std::sort(trees.begin(), trees.end(), [](const Landmark* a, const Landmark* b) {
    return std::make_pair(a->x_m, a->y_m) < std::make_pair(b->x_m, b->y_m);
  });
  return trees;
}

/// Direction of rising positions, consistent with the directions of all rows.
Vector2d forward_of(const std::vector<Vector2d>& directions, const RowsConfig& config) {
  Vector2d mean(0.0, 0.0);
  for (const Vector2d& u : directions) mean += u;
  if (config.numbering == RowNumbering::kDirection) {
    const double rad = config.forward_deg * geometry::kPi / 180.0;
    const Vector2d wanted(std::cos(rad), std::sin(rad));
    return mean.dot(wanted) < 0.0 ? Vector2d(-mean) : mean;
  }
  const double leading = std::abs(mean.y()) >= std::abs(mean.x()) ? mean.y() : mean.x();
  return leading < 0.0 ? Vector2d(-mean) : mean;
}

struct Lines {
  std::vector<Vector2d> p_map;
  RowDirections rows;
  std::vector<RowChain> chains;  ///< in lateral order, from the left
};

void turn_round(Lines& lines) {
  for (Vector2d& u : lines.rows.directions) u = -u;
  for (RowChain& chain : lines.chains) std::reverse(chain.begin(), chain.end());
  std::reverse(lines.chains.begin(), lines.chains.end());
}

/// Turns the numbering so that it starts at the corner nearest to the origin.
void begin_at_origin(Lines& lines, const Vector2d& origin) {
  const auto first = [&](const RowChain& chain) {
    return (lines.p_map[static_cast<std::size_t>(chain.front())] - origin).norm();
  };
  const auto last = [&](const RowChain& chain) {
    return (lines.p_map[static_cast<std::size_t>(chain.back())] - origin).norm();
  };
  const RowChain &left = lines.chains.front(), &right = lines.chains.back();
  if (std::min(last(left), last(right)) < std::min(first(left), first(right))) turn_round(lines);
  if (first(lines.chains.back()) < first(lines.chains.front())) {
    std::reverse(lines.chains.begin(), lines.chains.end());
  }
}

}  // namespace

std::vector<Row> find_rows(const std::vector<Landmark>& landmarks, const RowsConfig& config) {
  if (!config.has_rows()) return {};
  const std::vector<const Landmark*> trees = trees_of(landmarks);
  Lines lines;
  for (const Landmark* tree : trees) lines.p_map.push_back({tree->x_m, tree->y_m});
  const std::vector<double> strengths = row_strengths(trees);

  // First guess: links between trees of full strength that are next to each other.
  const std::vector<std::size_t> seeds = seed_trees(lines.p_map, strengths);
  std::vector<Vector2d> p_seeds;
  for (const std::size_t i : seeds) p_seeds.push_back(lines.p_map[i]);
  RowDirections guess = row_directions(p_seeds);
  if (guess.directions.empty()) return {};
  if (forward_of(guess.directions, config).dot(guess.directions.front()) < 0.0) {
    for (Vector2d& u : guess.directions) u = -u;
  }
  const Vector2d forward = forward_of(guess.directions, config).normalized();
  const auto runs_across = [&](const RowChain& chain) {
    const Vector2d chord =
        lines.p_map[index_of(chain.back())] - lines.p_map[index_of(chain.front())];
    return chord.dot(forward) < tuning::kAcross_cos * chord.norm();
  };
  std::vector<RowChain> known = row_chains(p_seeds, guess, kGapMax_slots);
  for (RowChain& chain : known) {
    for (std::int32_t& i : chain) i = static_cast<std::int32_t>(seeds[index_of(i)]);
  }

  // What the rows found so far tell of the orchard's rows decides which trees are in rows.
  std::vector<RowTrack> tracks;
  for (int round = 0; round < kLearningRounds; ++round) {
    known.erase(std::remove_if(known.begin(), known.end(), runs_across), known.end());
    const std::vector<LocalRows> local = local_rows(lines.p_map, guess.spacing_m, known);
    tracks = row_tracks(lines.p_map, strengths, local, known);
    known.clear();
    for (const RowTrack& track : tracks) known.push_back(track.chain);
    lines.rows.directions.clear();
    for (const LocalRows& here : local) lines.rows.directions.push_back(here.direction);
  }
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(),
                              [&](const RowTrack& track) { return runs_across(track.chain); }),
               tracks.end());
  keep_probable_rows(lines.p_map, tracks);
  if (tracks.empty()) return {};
  for (RowTrack& track : tracks) lines.chains.push_back(std::move(track.chain));
  lines.rows.spacing_m = guess.spacing_m;
  order_from_left(lines.p_map, lines.rows, lines.chains);
  if (config.numbering == RowNumbering::kOrigin) {
    begin_at_origin(lines, {config.origin_m[0], config.origin_m[1]});
  }

  const std::vector<std::vector<int>> positions = slot_indices(lines.p_map, lines.chains);
  std::vector<Landmark> numbered;
  for (std::size_t r = 0; r < lines.chains.size(); ++r) {
    for (std::size_t i = 0; i < lines.chains[r].size(); ++i) {
      Landmark& tree = numbered.emplace_back(*trees[index_of(lines.chains[r][i])]);
      tree.row = config.first_row + static_cast<int>(r);
      tree.position = config.first_position + positions[r][i];
    }
  }
  return numbered_rows(numbered);
}

void set_probability_by_order(const std::vector<Row>& rows, std::vector<Landmark>& landmarks) {
  if (rows.size() < 2) return;
  std::map<std::int32_t, double> of_rows;
  for (const Row& row : rows) {
    std::vector<std::int32_t> ids;
    for (const RowSlot& place : row.places) {
      if (place.landmark_id != 0) ids.push_back(place.landmark_id);
    }
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const auto num_to_end = static_cast<double>(std::min(i, ids.size() - 1 - i));
      of_rows[ids[i]] = 1.0 - std::pow(tuning::kGoesOn, num_to_end + 1.0);
    }
  }
  for (Landmark& l : landmarks) {
    const auto found = of_rows.find(l.id);
    l.probability =
        found != of_rows.end() ? found->second : std::min(l.probability, tuning::kTreesOutsideRows);
  }
}

std::string row_name(const RowNames& names, std::int32_t row, const std::string& prefix) {
  const auto name = names.find(row);
  return name == names.end() ? prefix + std::to_string(row) : name->second;
}

void number_landmarks(const std::vector<Row>& rows, std::vector<Landmark>& landmarks) {
  std::map<std::int32_t, std::pair<std::int32_t, std::int32_t>> numbers;
  for (const Row& row : rows) {
    for (const RowSlot& place : row.places) {
      if (place.landmark_id != 0) numbers[place.landmark_id] = {row.number, place.position};
    }
  }
  for (Landmark& l : landmarks) {
    const auto found = numbers.find(l.id);
    const auto number = found == numbers.end() ? std::make_pair(0, 0) : found->second;
    l.row = number.first;
    l.position = number.second;
  }
}

}  // namespace orchard::mapping
