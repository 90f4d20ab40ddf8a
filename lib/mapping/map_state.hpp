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

/// Observations, the newest, that a landmark's position is taken from: a robot that stands still
/// for an hour must not make each scan dearer than the last.
inline constexpr std::size_t kPositionSamplesMax = 512;

/// The map while it is built: landmarks (id = index + 1), every observation, cached positions.
struct MapState {
  MapState(const MapperConfig& mapper_config, std::shared_ptr<ChunkMemory> memory)
      : config(mapper_config), observations(std::move(memory)) {}

  /// Adds a candidate of the last scan to a landmark.
  void add_observation(std::int32_t index, const Candidate& candidate);

  /// Makes two landmarks one, with the index `keep`.
  void merge(std::int32_t keep, std::int32_t drop);

  /// Makes a landmark what these observations alone would have made of it; its existence stays that
  /// of `was`.
  void rebuild_landmark(std::int32_t index, const LandmarkRecord& was,
                        std::vector<std::int32_t> chain);

  /// Gives the landmark of index i the index kept[i]; indices that nobody has are removed ones.
  void renumber(const std::vector<std::int32_t>& kept);

  /// The mode of a landmark's newest observations.
  PositionMode mode_of(const LandmarkRecord& record) const;

  /// A landmark as it is published, with its position at that mode.
  Landmark report(std::int32_t index, const PositionMode& mode) const;

  /// Index of the landmark that each observation belongs to; -1 for one of none.
  ColdArray<std::int32_t> landmark_of_observation() const;

  /// The observations of a landmark, the newest first; none of one that is removed.
  std::vector<std::int32_t> observations_of(std::int32_t index) const;

  /// Whoever goes through all landmarks lets the memory of their observations rest after so many:
  /// neighbours by number share it.
  static constexpr std::int32_t kLandmarksBetweenRests = 64;

  MapperConfig config;
  LandmarkTable landmarks;
  ObservationStore observations;
  ModeCache modes;
};

}  // namespace orchard::mapping
