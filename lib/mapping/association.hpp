// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/candidate.hpp"
#include "mapping/landmark_record.hpp"
#include "mapping/mapper_config.hpp"

namespace orchard::mapping {

/// A candidate assigned to a landmark.
struct Pairing {
  double cost = 0.0;          ///< association cost; lower is better, no unit
  std::int32_t landmark = 0;  ///< index into the table
  std::size_t candidate = 0;  ///< index into the scan's candidates
};

/// Result of associating the candidates of one scan with the landmarks.
struct Association {
  std::vector<Pairing> pairs;      ///< one to one, in order of cost; relaxed-gate ones last
  std::vector<char> is_explained;  ///< per candidate: inside the gates of a landmark, paired or not
};

/// Assigns each candidate to at most one landmark and each landmark to at most one candidate.
/// Greedy by cost over all pairs inside the gates (distance, Mahalanobis distance, width).
/// Afterwards, a relaxed gate assigns candidates outside the Mahalanobis gate to well-known
/// landmarks that have no candidate in this scan.
Association associate(const std::vector<Candidate>& candidates, const LandmarkTable& landmarks,
                      const MapperConfig& config);

/// Position of the established landmark nearest to a point and nearer than `reach_m`; none
/// otherwise. Established landmarks have enough observations to guide scan alignment and are not
/// classified as objects.
std::optional<Eigen::Vector2d> nearest_established(const LandmarkTable& landmarks,
                                                   const Eigen::Vector2d& p_map, double reach_m);

/// Index of the landmark that this one must be merged with: the nearest within merge_m of similar
/// width that was not observed in the same scan. -1 = none; the lowest index among equally near
/// ones.
std::int32_t merge_partner(const LandmarkTable& landmarks, std::int32_t index,
                           const MapperConfig& config);

}  // namespace orchard::mapping
