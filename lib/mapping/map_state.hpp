// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "mapping/candidate.hpp"
#include "mapping/landmark.hpp"
#include "mapping/landmark_table.hpp"
#include "mapping/mapper_config.hpp"
#include "mapping/mode_cache.hpp"
#include "mapping/store/observation_store.hpp"

namespace orchard::mapping {

/// Maximum number of newest observations used for a landmark's position. Bounds the cost per scan
/// of a robot that stands still for hours.
inline constexpr std::size_t kPositionSamplesMax = 512;

/// The map under construction: landmarks (id = index + 1), all observations, cached positions.
struct MapState {
  MapState(const MapperConfig& mapper_config, std::shared_ptr<ChunkAllocator> memory)
      : config(mapper_config), observations(std::move(memory)) {}

  /// Adds a candidate of the last scan to a landmark.
  void add_observation(std::int32_t index, const Candidate& candidate);

  /// Merges landmark `drop` into landmark `keep`.
  void merge(std::int32_t keep, std::int32_t drop);

  /// Rebuilds a landmark from the observations in `chain` only; keeps the existence log odds of
  /// `was`.
  void rebuild_landmark(std::int32_t index, const LandmarkRecord& was,
                        std::vector<std::int32_t> chain);

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

}  // namespace orchard::mapping
