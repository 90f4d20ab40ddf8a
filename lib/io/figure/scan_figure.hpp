// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/figure/canvas.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"

namespace orchard::io {

/// Draws one scan from above, the robot's front up: its returns, what the rig takes for objects
/// with the width of each, what it refuses and why, the blind sector, and the reach of the
/// detector. Whether trunks lie where they stand, and are as wide, is seen at a glance. Returns the
/// file's bytes.
std::string scan_figure(const laser::Scan& scan, const laser::LaserConfig& laser,
                        const laser::SegmentationConfig& segmentation,
                        const laser::WidthConfig& width, const std::string& title,
                        FigureFormat format);

}  // namespace orchard::io
