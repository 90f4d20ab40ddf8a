// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "mapping/candidate.hpp"
#include "mapping/free_space.hpp"
#include "mapping/landmark.hpp"
#include "mapping/landmark_record.hpp"
#include "mapping/mapper_config.hpp"

namespace orchard::mapping {

/// Ground outline of a landmark, counter-clockwise in map [m]: a circle of its width, or for a
/// hedge or wall the area swept by that circle along its length. Empty without a width.
std::vector<Eigen::Vector2d> outline_of(const Landmark& landmark);

/// Extent of a landmark from its position [m]: half its width; for a clump (a bush, whose leaves
/// are hit differently by each scan) at least the extent of its observations.
double extent_radius_m(const LandmarkRecord& record);

/// Index of the landmark that forms one clump with landmark `index`: both are certainly not trees,
/// and their borders touch; or one is rather not a tree and overlaps the other. The clump is at
/// most `object_width_max_m` wide; larger objects stay several landmarks until map files are
/// written (join_long_objects). -1 if there is none.
std::int32_t touching_clump(const LandmarkTable& landmarks, std::int32_t index,
                            const MapperConfig& config);

/// Whether a detection is rather a tree than not, judged by the camera, or by the laser if no image
/// shows it. Trees in a bush are not parts of it.
bool looks_like_a_tree(const detection::Detection& detection);

/// Index of the clump that a candidate which does not look like a tree is part of; -1 if there is
/// none.
std::int32_t clump_around(const LandmarkTable& landmarks, const Candidate& candidate,
                          const MapperConfig& config);

/// Distinguishes stems from foliage by the scatter of a landmark's observations: a stem is hit at
/// the same position from every side, foliage at varying depth.
///
/// The limit is the scatter of the trees in the map's own rows, which depends on scanner, poses and
/// trunks. Without such trees, no landmark is a sharp stem.
class StemScatterTest {
 public:
  explicit StemScatterTest(const std::vector<Landmark>& landmarks);

  /// Whether a landmark is a tree that scatters no more than the trees of rows.
  bool contains(const Landmark& landmark) const;

 private:
  double scatter_max_m_ = 0.0;
};

/// Test of a map position against the scans.
using PositionTest = std::function<bool(const Eigen::Vector2d& p_map)>;

/// Evidence of the scans at a passage between two positions in map [m]. `half_depth_m`: of the
/// passage, to each side of the line between them; `clear_m`: how far a beam through it goes on.
using PassageTest =
    std::function<Passage(const Eigen::Vector2d& from_map, const Eigen::Vector2d& to_map,
                          double half_depth_m, double clear_m)>;

/// Joins the parts of objects longer than `object_width_max_m`, the width of the widest object that
/// a scan reports: scans show a hedge or wall as separate parts.
///
/// Two landmarks are parts of one object if their borders touch, or if every passage between them,
/// over at most `object_width_max_m`, was observed to be shut; but not if a passage anywhere
/// between their positions was observed open. A straight part of such landmarks, at most
/// `object_width_max_m` wide and longer than that, becomes one object with length and direction and
/// the lowest id. Stretches in line are joined unless a passage between them was observed free (a
/// gate). What stands in the outline of the whole, or in line with it a little beyond, is part of
/// it. Shorter groups are left unchanged, and so are landmarks for which `is_separate` is true:
/// trees of rows and trees by a camera. Returned in order of id.
std::vector<Landmark> join_long_objects(
    std::vector<Landmark> landmarks, double object_width_max_m, const PassageTest& passage,
    const PositionTest& is_free, const std::function<bool(const Landmark& landmark)>& is_separate);

/// Positions along a landmark's centre line, so close that discs of its width cover it; for a round
/// one its position.
std::vector<Eigen::Vector2d> centre_line(const Landmark& landmark);

}  // namespace orchard::mapping
