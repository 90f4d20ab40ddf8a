// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// The navigation graph as GeoJSON for Nav2's route server, in metres of the frame map.
///
/// Nav2 drives straight from node to node: each bend of a line is a node, and each piece an edge in
/// either direction. The ends of an aisle are named after the row at its left, in `metadata`:
/// R1_IN at the row's first tree, R1_OUT at its last. Ids are unique among nodes and edges.
std::string route_graph(const mapping::NavigationGraph& graph, const mapping::RowNames& row_names);

/// The same graph as a tmap2, the topological map of L-CAS's topological_navigation (its schema of
/// 2026), in YAML's JSON form: nodes by name, bends N1, N2 ..., each with a zone as wide as the
/// narrowest line that ends there, edges both ways with the action NavigateToPose. `name`: of map
/// and pointset; `utime`: its last_updated.
std::string topological_map(const mapping::NavigationGraph& graph,
                            const mapping::RowNames& row_names, const std::string& name,
                            std::int64_t utime);

/// A map as map_server reads it: an image (PGM) and its YAML.
struct OccupancyGrid {
  std::string pgm;
  std::string yaml;
  double resolution_m = 0.0;
};

/// Draws landmarks by their outlines as occupied, and the ground of aisles, headlands and paths as
/// free: aisles as wide as they were observed, paths as wide as the narrowest way. The rest is
/// unknown. Cells are 0.05 m, and for a large map so much more that the image has at most 100
/// million. `image_name`: of the PGM, beside the YAML.
OccupancyGrid occupancy_grid(const std::vector<mapping::Landmark>& landmarks,
                             const mapping::NavigationGraph& graph,
                             const std::vector<std::vector<pose::PoseEstimate>>& paths,
                             const std::string& image_name);

/// A path as KITTI's odometry benchmark has it: a line per pose, the upper 3 x 4 of T_map_base.
std::string kitti_poses(const std::vector<pose::PoseEstimate>& path);

}  // namespace orchard::io
