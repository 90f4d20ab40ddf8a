// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/georeference.hpp"

namespace orchard::io {

enum class GeoGeometry { kPoint, kLine, kArea };
enum class GeoType { kInteger, kInteger64, kReal, kText };

struct GeoField {
  const char* name;
  GeoType type;
};

/// File formats for a map's layers.
enum class GeoFormat { kGeoPackage, kGeoJson, kKml, kShapefile, kDxf, kCsv, kFlatGeobuf };

/// Name and properties of a format.
struct GeoFormatInfo {
  GeoFormat format;
  const char* word;       ///< "geojson"
  const char* extension;  ///< ".geojson"
  bool has_one_layer;
  bool is_on_earth;  ///< stores latitude and longitude only: needs a georeference
  const char* lost;  ///< what it cannot store, as a sentence; "": nothing
};

/// Lists all formats, GeoPackage first.
const std::vector<GeoFormatInfo>& geo_formats();

/// Name of the coordinate system in which a format stores a map.
std::string geo_system_text(const std::optional<geometry::Georeference>& georeference,
                            const GeoFormatInfo& format);

/// Value of a field, of the field's type; a default-constructed one leaves the field empty.
struct GeoValue {
  enum class Kind { kNone, kInteger, kReal, kText };

  GeoValue() = default;
  GeoValue(std::int64_t value) : kind(Kind::kInteger), integer(value) {}
  GeoValue(double value) : kind(Kind::kReal), real(value) {}
  GeoValue(std::string value) : kind(Kind::kText), text(std::move(value)) {}

  Kind kind = Kind::kNone;
  std::int64_t integer = 0;
  double real = 0.0;
  std::string text;
};

/// Definition of a layer.
struct GeoLayer {
  const char* name;
  GeoGeometry geometry;
  const char* description;  ///< one sentence for the user
  std::vector<GeoField> fields;
  std::string qml{};  ///< QGIS style (qgis_style.hpp); empty: QGIS's default
};

/// A GIS file written in memory, layer by layer.
///
/// Points are given in map. With a georeference they are written in the UTM zone of its datum (WGS
/// 84), or as latitude and longitude if the format supports nothing else; without one in a local
/// metric system that is not tied to the earth. A GeoPackage of equal content has equal bytes.
/// Throws FileError when GDAL fails.
class GeoFile {
 public:
  explicit GeoFile(const std::optional<geometry::Georeference>& georeference,
                   GeoFormat format = GeoFormat::kGeoPackage);
  ~GeoFile();
  GeoFile(const GeoFile&) = delete;
  GeoFile& operator=(const GeoFile&) = delete;

  /// Writes only this layer and omits all others. Without this call, a format with one layer
  /// contains the first one.
  void choose_layer(const std::string& name);

  /// Stores a metadata item in a GeoPackage, for reading the file back.
  void set_metadata(const char* name, const std::string& value);

  /// Starts a layer; the following features are added to it.
  void begin_layer(const GeoLayer& layer);

  /// Adds a feature: one value per field, and its points (one for kPoint, two or more for kLine;
  /// for kArea the boundary of three or more, without repeating the first).
  void add(const std::vector<GeoValue>& values, const std::vector<Eigen::Vector2d>& points_map);

  /// Layers that were omitted.
  const std::vector<std::string>& left_out() const;

  /// Layers that were written, with the number of their features.
  const std::vector<std::pair<std::string, std::size_t>>& written() const;

  /// Returns the file's bytes; nothing can be added afterwards.
  std::string finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::io
