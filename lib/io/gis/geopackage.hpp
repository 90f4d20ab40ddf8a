// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
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

/// A coordinate in metres as files store it: to a tenth of a millimetre, as map.csv does. Rounded,
/// because the last bits of sines and cosines depend on the processor.
double stored_m(double coordinate_m);

/// Any other number as files store it, likewise; a billionth of a degree is a tenth of a
/// millimetre.
double stored_value(double value);

/// Definition of a layer.
struct GeoLayer {
  const char* name;
  GeoGeometry geometry;
  const char* description;  ///< one sentence for the user
  std::vector<GeoField> fields;
  std::string qml{};         ///< QGIS style (qgis_style.hpp); empty: QGIS's default
  bool has_heights = false;  ///< points with a third coordinate where their height is known
};

/// A GIS file written in memory, layer by layer. Points are given in map.
class LayerFile {
 public:
  virtual ~LayerFile() = default;
  LayerFile(const LayerFile&) = delete;
  LayerFile& operator=(const LayerFile&) = delete;

  /// Writes only this layer and omits all others. Without this call, a format with one layer
  /// contains the first one.
  void choose_layer(const std::string& name) { chosen_ = name; }

  /// Stores a metadata item for reading the file back, if the format has a place for it.
  virtual void set_metadata(const char*, const std::string&) {}

  /// Starts a layer; the following features are added to it.
  void begin_layer(const GeoLayer& layer);

  /// Adds a feature: one value per field, and its points (one for kPoint, two or more for kLine;
  /// for kArea the boundary of three or more, without repeating the first). `height_m`: of a point,
  /// above the ellipsoid if there is a georeference, else above map's origin.
  void add(const std::vector<GeoValue>& values, const std::vector<Eigen::Vector2d>& points_map,
           const std::optional<double>& height_m = {});

  /// Layers that were omitted.
  const std::vector<std::string>& left_out() const { return left_out_; }

  /// Layers that were written, with the number of their features.
  const std::vector<std::pair<std::string, std::size_t>>& written() const { return written_; }

  /// Returns the file's bytes; nothing can be added afterwards. Throws FileError when the file
  /// cannot be made.
  virtual std::string finish() = 0;

  /// After finish(): the files that belong beside it with its name, by extension (".dbf").
  virtual std::map<std::string, std::string> companions() const { return {}; }

 protected:
  explicit LayerFile(bool has_one_layer) : has_one_layer_(has_one_layer) {}
  virtual void open_layer(const GeoLayer& layer) = 0;
  virtual void write_feature(const std::vector<GeoValue>& values,
                             const std::vector<Eigen::Vector2d>& points_map,
                             const std::optional<double>& height_m) = 0;

 private:
  bool has_one_layer_;
  bool is_open_ = false;  ///< the current layer is written
  std::string chosen_;    ///< empty: all, or the first of a format with one layer
  std::vector<std::string> left_out_;
  std::vector<std::pair<std::string, std::size_t>> written_;
};

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
                     const std::vector<Eigen::Vector2d>& points_map,
                     const std::optional<double>& height_m) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::io
