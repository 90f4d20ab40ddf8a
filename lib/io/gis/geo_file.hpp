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

/// Files that can hold a map's layers.
enum class GeoFormat { kGeoPackage, kGeoJson, kKml, kShapefile, kDxf, kCsv, kFlatGeobuf };

/// A format as people name it, and what it does to a map.
struct GeoFormatInfo {
  GeoFormat format;
  const char* word;       ///< "geojson"
  const char* extension;  ///< ".geojson"
  bool has_one_layer;
  bool is_on_earth;  ///< holds latitude and longitude alone: needs a georeference
  const char* lost;  ///< what it cannot hold, as a sentence; "": nothing
};

/// All of them; GeoPackage first.
const std::vector<GeoFormatInfo>& geo_formats();

/// The coordinate system in which a format holds a map, in words.
std::string geo_system_text(const std::optional<geometry::Georeference>& georeference,
                            const GeoFormatInfo& format);

/// A value of its field's type; one made of nothing leaves the field empty.
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

/// A layer as it begins.
struct GeoLayer {
  const char* name;
  GeoGeometry geometry;
  const char* description;  ///< for people, in a sentence
  std::vector<GeoField> fields;
  std::string qml{};  ///< how QGIS draws it; empty: as it likes (qgis_style.hpp)
};

/// A file for geographic information systems that is written in memory, layer by layer.
///
/// Points are given in map. With a georeference they are written in the UTM zone of its datum, or
/// as latitude and longitude where the format knows nothing else (WGS 84); without one in a local
/// metric system that is not tied to the earth. A GeoPackage of equal content has equal bytes.
/// Throws FileError when GDAL fails.
class GeoFile {
 public:
  explicit GeoFile(const std::optional<geometry::Georeference>& georeference,
                   GeoFormat format = GeoFormat::kGeoPackage);
  ~GeoFile();
  GeoFile(const GeoFile&) = delete;
  GeoFile& operator=(const GeoFile&) = delete;

  /// Only this layer is written, all others are left out. Of a format with one layer the first one
  /// stays without it.
  void choose_layer(const std::string& name);

  /// Says a word about the file to those who read it again: a GeoPackage's metadata.
  void set_metadata(const char* name, const std::string& value);

  /// Starts a layer; what is added from now on goes there.
  void begin_layer(const GeoLayer& layer);

  /// One feature: a value per field, and its points (one for kPoint, two or more
  /// for kLine; of kArea its border, three or more, the first not again).
  void add(const std::vector<GeoValue>& values, const std::vector<Eigen::Vector2d>& points_map);

  /// Layers that were left out.
  const std::vector<std::string>& left_out() const;

  /// Layers that were begun and not left out, with the number of their features.
  const std::vector<std::pair<std::string, std::size_t>>& written() const;

  /// The file's bytes; nothing can be added afterwards.
  std::string finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::io
