// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "mapping/candidate.hpp"
#include "mapping/landmark.hpp"
#include "mapping/landmark_record.hpp"
#include "mapping/mapper_config.hpp"
#include "mapping/position_mode.hpp"
#include "mapping/store/observation_store.hpp"

namespace orchard::mapping {

/// derived: Maximum number of newest observations used for a landmark's position. Bounds the cost
/// per scan of a robot that stands still for hours.
inline constexpr std::size_t kPositionSamplesMax = 512;

/// Changes of the map by one scan: ids of new or changed landmarks, and ids removed because they
/// were merged or no longer exist. Both in ascending order.
struct MapUpdate {
  std::vector<std::int32_t> changed_ids;
  std::vector<std::int32_t> removed_ids;
};

/// The map under construction: landmarks (id = index + 1), all observations, cached positions.
struct MapState {
  MapState(const MapperConfig& mapper_config, std::shared_ptr<ChunkAllocator> memory)
      : config(mapper_config), observations(std::move(memory)) {}

  /// Adds a candidate of the last scan to a landmark.
  void add_observation(std::int32_t index, const Candidate& candidate);

  /// Merges landmark `drop` into landmark `keep`.
  void merge(std::int32_t keep, std::int32_t drop);

  /// Moves the landmark of index i to index kept[i]; unused indices become removed records.
  void renumber(const std::vector<std::int32_t>& kept);

  /// Mode of the landmark's newest observations.
  PositionMode mode_of(const LandmarkRecord& record) const;

  /// A landmark as published, at the position `mode`.
  Landmark report(std::int32_t index, const PositionMode& mode) const;

  /// Landmark index of each observation; -1 for unassociated ones.
  ChunkedArray<std::int32_t> landmark_of_observation() const;

  /// Observations of a landmark, newest first; empty for a removed one.
  std::vector<std::int32_t> observations_of(std::int32_t index) const;

  MapperConfig config;
  LandmarkTable landmarks;
  ObservationStore observations;
  ModeCache modes;
};

/// Landmarks whose observations disagree on the class.
struct LabelConflicts {
  int num_conflicting = 0;      ///< landmarks whose fraction of TREE labels supports neither class
  int num_with_tree_label = 0;  ///< landmarks with at least one TREE label
};

/// Counts over landmarks with at least ten judged observations; uses the newest 512 of each.
LabelConflicts count_label_conflicts(const MapState& map);

/// Assigns earlier indices to the landmarks of a rebuilt map. Returns one entry per new index.
///
/// `then_of(now)` returns, for each observation of new landmark `now`, the index of its earlier
/// landmark (-1: none). Pairs of earlier and new landmarks are assigned greedily by the number of
/// shared observations; ties go to the lower earlier index, then to the lower new one. Each index
/// is assigned once. Remaining new landmarks get indices from `first_unused` on, in order; those
/// without observations get -1.
std::vector<std::int32_t> keep_indices(
    const std::function<std::vector<std::int32_t>(std::int32_t now)>& then_of, std::int32_t num_now,
    std::int32_t first_unused);

}  // namespace orchard::mapping
