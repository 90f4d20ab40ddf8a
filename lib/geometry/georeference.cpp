// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/georeference.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/UTMUPS.hpp>
#include <cmath>

#include "geometry/pose2.hpp"

namespace orchard::geometry {
namespace {

constexpr double kFalseNorthing_m = 1e7;  // physical: UTM, southern hemisphere

struct Zone {
  int number = 0;
  bool is_north = true;
};

Zone zone_of(const Georeference& g) {
  return {GeographicLib::UTMUPS::StandardZone(g.latitude_deg, g.longitude_deg),
          g.latitude_deg >= 0.0};
}

}  // namespace

Geodetic geodetic_of(const Georeference& g, const Eigen::Vector2d& p_map) {
  const Eigen::Vector2d p_enu = transform(Pose2{g.x_m, g.y_m, g.yaw_rad}, p_map);
  const GeographicLib::LocalCartesian enu(g.latitude_deg, g.longitude_deg, g.altitude_m);
  Geodetic place;
  double altitude_m = 0.0;
  enu.Reverse(p_enu.x(), p_enu.y(), 0.0, place.latitude_deg, place.longitude_deg, altitude_m);
  return place;
}

Eigen::Vector2d map_of(const Georeference& g, const Geodetic& place) {
  const GeographicLib::LocalCartesian enu(g.latitude_deg, g.longitude_deg, g.altitude_m);
  Eigen::Vector2d p_enu;
  double up_m = 0.0;
  enu.Forward(place.latitude_deg, place.longitude_deg, g.altitude_m, p_enu.x(), p_enu.y(), up_m);
  return inverse_transform(Pose2{g.x_m, g.y_m, g.yaw_rad}, p_enu);
}

int utm_epsg(const Georeference& g) {
  const Zone zone = zone_of(g);
  if (zone.number == GeographicLib::UTMUPS::UPS) return zone.is_north ? 5041 : 5042;
  return (zone.is_north ? 32600 : 32700) + zone.number;
}

Eigen::Vector2d utm_of(const Georeference& g, const Eigen::Vector2d& p_map) {
  const Geodetic place = geodetic_of(g, p_map);
  const Zone zone = zone_of(g);
  int number = 0;
  bool is_north = true;
  Eigen::Vector2d p_utm;
  GeographicLib::UTMUPS::Forward(place.latitude_deg, place.longitude_deg, number, is_north,
                                 p_utm.x(), p_utm.y(), zone.number);
  // The datum's hemisphere decides for all points: an orchard across the equator keeps one false
  // northing.
  if (zone.number != GeographicLib::UTMUPS::UPS && is_north != zone.is_north) {
    p_utm.y() += zone.is_north ? -kFalseNorthing_m : kFalseNorthing_m;
  }
  return p_utm;
}

}  // namespace orchard::geometry
