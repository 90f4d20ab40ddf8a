// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace orchard::geometry {

/// Where on the earth a map lies: its frame in an east-north-up frame about a datum (WGS 84).
struct Georeference {
  double latitude_deg = 0.0;  ///< of the datum
  double longitude_deg = 0.0;
  double altitude_m = 0.0;      ///< above the ellipsoid
  double x_m = 0.0;             ///< T_enu_map: where the map's origin lies east of the datum
  double y_m = 0.0;             ///< and north
  double yaw_rad = 0.0;         ///< of the map's x axis, counter-clockwise from east
  double residual_rms_m = 0.0;  ///< of the satellite fixes about the map they place
};

/// Worse than this, a map's place on the earth is warned about.
inline constexpr double kGeoreferenceResidualMax_m = 0.3;

struct Geodetic {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
};

/// A point of map on the earth.
Geodetic geodetic_of(const Georeference& georeference, const Eigen::Vector2d& p_map);

/// A place on the earth as a point of map; heights apart, the inverse of geodetic_of().
Eigen::Vector2d map_of(const Georeference& georeference, const Geodetic& place);

/// EPSG code of the UTM zone that the datum lies in (UPS near the poles), WGS 84.
int utm_epsg(const Georeference& georeference);

/// Easting and northing [m] of a point of map in that zone, also beyond its borders.
Eigen::Vector2d utm_of(const Georeference& georeference, const Eigen::Vector2d& p_map);

}  // namespace orchard::geometry
