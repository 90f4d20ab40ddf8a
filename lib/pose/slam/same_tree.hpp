// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "geometry/point_grid.hpp"
#include "geometry/visibility.hpp"
#include "pose/field_of_view.hpp"
#include "pose/graph/graph.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// Min number of keyframes that confirm a landmark; derived: two may be by chance.
inline constexpr int kConfirmKeyframes = 3;

/// Returns the occlusion test for the objects that a keyframe observed, other than `except`.
inline geometry::OcclusionTest occlusion_by(const Keyframe& keyframe, const SlamGraph& graph,
                                            int except = -1) {
  geometry::OcclusionTest occlusion;
  for (const SlamObservation& o : keyframe.observations) {
    if (o.landmark != except) occlusion.add(o.position(), graph.landmarks[o.landmark].width_m);
  }
  return occlusion;
}

/// Properties of the trees of a map that tell how likely two of them look like one.
class TreeStatistics {
 public:
  /// `index`: spatial index of the landmarks. `reach_m`: max radius of the densities.
  TreeStatistics(const SlamGraph& graph, const geometry::PointGrid& index, double reach_m);

  /// Returns the number of pairs of trees within a distance that were observed together.
  int num_pairs(double radius_m) const;

  /// Returns the density of other trees within a distance of a tree, from the trees that were
  /// observed together: near a tree they are rarer than on average.
  double density_per_m2(double radius_m) const;

  /// Returns the density of the trees' widths, each known to sd_m.
  double width_density_per_m(double width_m, double sd_m) const;

 private:
  double reach_m_;
  std::vector<double> apart_m_;  ///< of the pairs observed together, ascending
  std::vector<double> widths_m_;
};

/// Returns the log-likelihood ratio of two landmarks being one tree, against two, by their
/// positions and widths. `relative_m2`: covariance of their relative position.
double same_tree_log_ratio(const SlamLandmark& a, const SlamLandmark& b,
                           const Eigen::Matrix2d& relative_m2, const TreeStatistics& trees,
                           const SlamConfig& config);

/// Returns the log-likelihood ratio of two landmarks being one tree, against two, by the keyframes
/// that observed the one and should have observed the other, too. A tree in view is missed as often
/// as other trees there are missed. 0 with fewer than kConfirmKeyframes such keyframes.
double missed_log_ratio(const SlamGraph& graph, const geometry::PointGrid& index,
                        const SensorCoverage& coverage, int seen, int missed);

/// Finds the pairs of landmarks of a solved graph that are one tree, the surest first, the lower
/// index first in each.
///
/// Candidates are nearer to each other than new_landmark_m or the spacing of trees that were
/// observed together. Those observed by one keyframe are one tree if they overlap, as the trunks of
/// two trees never do, else two. The log-likelihood ratio of any other pair must leave few false
/// pairs, given the number of trees expected around. `index`: spatial index of the landmarks.
std::vector<std::pair<int, int>> find_same_trees(const SlamGraph& graph,
                                                 const geometry::PointGrid& index,
                                                 const SensorCoverage& coverage,
                                                 const SlamConfig& config);

/// True if the trunks of two landmarks overlap.
bool trunks_overlap(const SlamLandmark& a, const SlamLandmark& b);

}  // namespace orchard::pose
