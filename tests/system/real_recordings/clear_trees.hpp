// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/recording/recording_folder.hpp"
#include "mapping/landmark.hpp"

namespace orchard::test {

/// A place in map where the narrow, free-standing things that scans saw pile up.
struct ClearTree {
  double x_m = 0.0;
  double y_m = 0.0;
  double support = 0.0;  ///< about how many observations
};

/// Finds the clear trees of a recording without any of the mapper's parts: cuts the raw scans at
/// range jumps, keeps what is narrow and stands free, puts it where the recording's own track says
/// base was, and climbs to the peaks of the density (Gaussian, 0.15 m). Peaks at least 1 m apart
/// that 15 or more observations support, the best supported first; of a drive whose scans were
/// thinned to `share` of what they were, that fraction of 15.
///
/// The limits are those of pullally_drive_1; the laser sits in base's origin. Scans of whose time
/// there is no POSE_FIX are left out.
std::vector<ClearTree> find_clear_trees(const std::vector<io::SensorMessage>& recording,
                                        double fraction = 1.0);

/// How a map has the clear trees.
struct ClearTreeComparison {
  std::vector<int> num_landmarks;   ///< per clear tree: tree landmarks within 0.5 m
  std::vector<double> distances_m;  ///< of those that have exactly one, rising
  int num_tree_landmarks = 0;       ///< seen ten times (`share` of it) or more: only these count

  int num_with(int num) const;       ///< clear trees that have so many
  int num_doubled() const;           ///< clear trees that have more than one
  double median_distance_m() const;  ///< 0 without any
};

/// Whether two things stand within 0.5 m of each other.
bool is_same_place(const ClearTree& a, const ClearTree& b);

ClearTreeComparison compare(const std::vector<ClearTree>& clear_trees,
                            const std::vector<mapping::Landmark>& map, double fraction = 1.0);

/// What people read of a comparison: three lines, and one per tree that has not exactly one.
std::string report(const std::vector<ClearTree>& clear_trees,
                   const ClearTreeComparison& comparison);

/// Its last part alone.
std::string report_of_misses(const std::vector<ClearTree>& clear_trees,
                             const ClearTreeComparison& comparison);

}  // namespace orchard::test
