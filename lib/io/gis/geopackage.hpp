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

enum class GeoGeometry { kPoint, kLine };
enum class GeoType { kInteger, kInteger64, kReal, kText };

struct GeoField {
  const char* name;
  GeoType type;
};

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

/// A GeoPackage (SQLite) that is written in memory, layer by layer.
///
/// Points are given in map. With a georeference they are written in the UTM zone of its datum
/// (WGS 84), else in a local metric system "map" that is not tied to the earth. Equal content gives
/// equal bytes. Throws FileError when GDAL fails.
class GeoPackage {
 public:
  explicit GeoPackage(const std::optional<geometry::Georeference>& georeference);
  ~GeoPackage();
  GeoPackage(const GeoPackage&) = delete;
  GeoPackage& operator=(const GeoPackage&) = delete;

  /// Starts a layer; what is added from now on goes there.
  void begin_layer(const char* name, GeoGeometry geometry, const std::vector<GeoField>& fields);

  /// One feature: a value per field, and its points (one for kPoint, else at least two).
  void add(const std::vector<GeoValue>& values, const std::vector<Eigen::Vector2d>& points_map);

  /// The file's bytes; nothing can be added afterwards.
  std::string finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::io
