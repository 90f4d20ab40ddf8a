// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

#include "io/config/config.hpp"

namespace orchard::test {

/// What a simulated drive's album is worth, by where the simulator put every tree and the robot.
struct AlbumOutcome {
  int num_true_trees = 0;     ///< that stand there
  int num_trees = 0;          ///< trees of the map that are true ones
  int num_photographed = 0;   ///< of those: with a photograph
  int num_centred = 0;        ///< of those: the true trunk's axis is in its middle third, both ways
  int num_same = 0;           ///< of those: the photograph shows what the picture shows there
  std::size_t num_bytes = 0;  ///< of all photographs
};

/// Drives through the orchard of that seed. `folder`: where to write the map folder; "": nowhere.
AlbumOutcome run_album(const io::Config& config, unsigned long seed, const std::string& folder);

}  // namespace orchard::test
