// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "geometry/georeference.hpp"
#include "view/map_data.hpp"

namespace orchard::io {

/// Reads what a GeoTIFF, or an MBTiles or GeoPackage of tiles, shows of `box_map`, turned into the
/// map frame: white where it shows nothing, at its own resolution, or a coarser one that browsers
/// of telephones can draw. In a confined process (confined.hpp). Throws FileError naming the file.
view::Background background_of(const std::string& path, const geometry::Georeference& georeference,
                               const Eigen::AlignedBox2d& box_map);

}  // namespace orchard::io
