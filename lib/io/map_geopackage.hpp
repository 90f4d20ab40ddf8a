// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// A GeoPackage (SQLite) as bytes: layers `landmarks` (points with the columns of map.csv), `path`
/// (one line), `rows` (a line per row) and `gaps` (a point per place without a tree), all in a
/// local metric system "map" that is not tied to the earth. Equal content gives equal bytes. Throws
/// FileError when GDAL fails.
std::string map_geopackage(const std::vector<mapping::Landmark>& landmarks,
                           const std::vector<pose::PoseEstimate>& trajectory,
                           const std::vector<mapping::Row>& rows);

}  // namespace orchard::io
