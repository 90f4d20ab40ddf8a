// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/observation_store.hpp"

namespace orchard::mapping {

/// One observation, of a landmark or a second echo of it, in map.
struct Piece {
  std::int32_t observation = 0;
  std::int32_t scan = 0;
  Eigen::Vector2d p_map;
};

/// What the newest scans (100 at most) of a landmark's chain show within `reach_m` of a point, by
/// the poses as given, in order of scan; a scan's observations of other landmarks too.
std::vector<Piece> pieces_around(const ObservationStore& observations, std::int32_t head,
                                 const Eigen::Vector2d& p_map, double reach_m);

/// Whether scans show something at both places at once, time and again: five of them, and three in
/// ten of those that show something at the place that is seen less; and little between them: a bush
/// or a hedge fills what lies between its parts. A pose that was off now and then shows one thing
/// at two places, but never at once.
bool are_two_things(const std::vector<Piece>& pieces, const Eigen::Vector2d& a,
                    const Eigen::Vector2d& b);

/// The two places, the better seen one first, where two things stand whose observations one
/// landmark has taken: farther than `apart_m` from each other, the lesser seen by ten scans and
/// half as often as the other one, both at once as above.
struct TwoPlaces {
  Eigen::Vector2d first, second;
};
std::optional<TwoPlaces> two_places(const std::vector<Piece>& pieces, double apart_m);

}  // namespace orchard::mapping
