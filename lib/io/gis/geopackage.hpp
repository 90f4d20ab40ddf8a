// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/gis/geo_layer.hpp"

namespace orchard::io {

/// The local metric system of a map without a georeference, as WKT. With axes, so that every
/// program treats it as a plane in metres.
inline constexpr char kLocalSystem[] =
    "LOCAL_CS[\"Orchard map (local)\",LOCAL_DATUM[\"Where the first drive began\",0],"
    "UNIT[\"metre\",1],AXIS[\"x\",EAST],AXIS[\"y\",NORTH]]";

/// A GeoPackage 1.2 (OGC 12-128r14), with spatial indexes and the styles that QGIS keeps in it.
///
/// Written by SQLite alone, so that a program on the robot does not load GDAL for it. Points are
/// stored in the UTM zone of the georeference's datum, or in the local system. Equal content gives
/// equal bytes. Throws FileError when SQLite fails.
class GeoPackage final : public LayerFile {
 public:
  explicit GeoPackage(const std::optional<geometry::Georeference>& georeference);
  ~GeoPackage() override;

  void set_metadata(const char* name, const std::string& value) override;
  std::string finish() override;

 protected:
  void open_layer(const GeoLayer& layer) override;
  void write_feature(const std::vector<GeoValue>& values,
                     const std::vector<Eigen::Vector2d>& points_map) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::io
