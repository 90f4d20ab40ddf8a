// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "io/figure/canvas.hpp"
#include "io/figure/map_frame.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// Draws a map like figure 11 of the paper (Shalal et al. 2013): trees in rows green with their
/// numbers, other trunks pale green and objects red with #id, unseen ones grey, the robot's path,
/// the rows with their names, the aisles and headlands, axes in metres of equal scale. Circles have
/// the true width, with a minimum size. Labels do not overlap: where space is short, only every
/// 2nd, 5th, 10th ... number is drawn. A PDF has the size of A3 to fit more labels. Returns the
/// file.
std::string map_figure(const std::vector<mapping::Landmark>& landmarks,
                       const std::vector<pose::PoseEstimate>& trajectory,
                       const std::vector<mapping::Row>& rows, const mapping::NavigationGraph& graph,
                       FigureFormat format, const MapHeading& heading = {},
                       const mapping::RowNames& row_names = {});

}  // namespace orchard::io
