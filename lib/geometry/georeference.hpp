// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace orchard::geometry {

/// Georeference of a map: the pose of its frame in an east-north-up (ENU) frame about a datum (WGS
/// 84).
struct Georeference {
  double latitude_deg = 0.0;  ///< of the datum
  double longitude_deg = 0.0;
  double altitude_m = 0.0;      ///< above the ellipsoid
  double x_m = 0.0;             ///< T_enu_map: position of the map's origin, east of the datum
  double y_m = 0.0;             ///< north of the datum
  double yaw_rad = 0.0;         ///< of the map's x axis, counter-clockwise from east
  double residual_rms_m = 0.0;  ///< of the satellite fixes that gave the georeference
};

/// physical: a fix without RTK; above this residual the user is warned about the georeference.
inline constexpr double kGeoreferenceResidualMax_m = 0.3;

struct Geodetic {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

/// Converts a point of the map frame to latitude and longitude.
Geodetic geodetic_of(const Georeference& georeference, const Eigen::Vector2d& p_map);

/// Converts latitude and longitude to a point of the map frame: the inverse of geodetic_of(),
/// without heights.
Eigen::Vector2d map_of(const Georeference& georeference, const Geodetic& place);

/// EPSG code of the datum's UTM zone (UPS near the poles), WGS 84.
int utm_epsg(const Georeference& georeference);

/// Converts a point of the map frame to easting and northing [m] in the zone of utm_epsg(), also
/// outside the zone's borders.
Eigen::Vector2d utm_of(const Georeference& georeference, const Eigen::Vector2d& p_map);

}  // namespace orchard::geometry
