// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/recording/recording_folder.hpp"
#include "mapping/landmark.hpp"
#include "pose/pose_estimate.hpp"
#include "system/real_recordings/clear_trees.hpp"

namespace orchard::test {

/// A map and the path that it was made with.
struct MappedDrive {
  std::vector<mapping::Landmark> map;
  std::vector<pose::PoseEstimate> trajectory;
};

/// How closely the observations of one tree lie together.
struct TreeScatter {
  std::vector<double> medians_m;  ///< per clear tree: of its observations from its landmark, rising
  int num_observations = 0;

  double median_m() const;  ///< of the trees; 0 without any
};

/// Places the free-standing things of each scan, up to 5 m away, by the path of a map; a tree's
/// observation is the nearest one of a scan within 1 m of its landmark. Of clear trees that have
/// exactly one tree landmark and ten observations.
TreeScatter tree_scatter(const std::vector<io::SensorMessage>& recording, const MappedDrive& drive,
                         const std::vector<ClearTree>& clear_trees);

/// Whether two maps of one drive hold the same trees.
struct SameTrees {
  int num_in_both = 0;  ///< clear trees with exactly one landmark in each, within 0.5 m
  int num_missing = 0;  ///< the others of the first map's
  int num_extra = 0;    ///< landmarks within 1 m of a clear tree that only the second has
  std::vector<double> distances_m;  ///< of those in both, rising
};

/// Lays the second map upon the first by the two paths, rigidly, and looks for the first's clear
/// trees (those with exactly one tree landmark) in it.
SameTrees same_trees(const std::vector<ClearTree>& clear_trees, const MappedDrive& first,
                     const MappedDrive& second);

std::string report(const TreeScatter& scatter);
std::string report(const SameTrees& same);

}  // namespace orchard::test
