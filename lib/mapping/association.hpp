// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "mapping/candidate.hpp"
#include "mapping/landmark_table.hpp"
#include "mapping/mapper_config.hpp"

namespace orchard::mapping {

/// A candidate that is a landmark's.
struct Pairing {
  double cost = 0.0;          ///< the less, the surer; no unit
  std::int32_t landmark = 0;  ///< index into the table
  std::size_t candidate = 0;  ///< index into the scan's candidates
};

/// Who is who in one scan.
struct Association {
  std::vector<Pairing> pairs;      ///< one to one, in order of cost; relaxed-gate ones last
  std::vector<char> is_explained;  ///< per candidate: within the gates of a landmark, paired or not
};

/// Pairs each candidate with at most one landmark and each landmark with at most one candidate:
/// of all pairs within the gates (distance, standard deviations, width) the surest first; then, by
/// a relaxed gate, candidates beyond the standard deviations of a well-known landmark that the scan
/// shows nowhere else.
Association associate(const std::vector<Candidate>& candidates, const LandmarkTable& landmarks,
                      const MapperConfig& config);

/// The established landmark nearest to a point and nearer than `reach_m`: one seen often enough to
/// lead a scan, and not known to be an object.
std::optional<Eigen::Vector2d> nearest_established(const LandmarkTable& landmarks,
                                                   const Eigen::Vector2d& p_map, double reach_m);

/// Whether scans show two landmarks (of these indices) at once, time and again.
using AreTwo = std::function<bool(std::int32_t, std::int32_t)>;

/// The landmark that must be the same thing as this one: the nearest within merge_m, of much the
/// same width, not seen in the same scan and, farther than split_distance_m, not known to be two.
/// -1 = none; of equally near ones the lowest index.
std::int32_t merge_partner(const LandmarkTable& landmarks, std::int32_t index,
                           const MapperConfig& config, const AreTwo& are_two);

}  // namespace orchard::mapping
