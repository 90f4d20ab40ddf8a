// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/georeference.hpp"

class OGRCoordinateTransformation;

namespace orchard::io {

/// What of a file's geometries is kept.
enum class VectorShape : std::uint8_t { kNone, kPoint, kLine, kOther };

struct VectorFeature {
  std::int64_t number = 0;          ///< its id in the file
  std::vector<std::string> values;  ///< one per field; empty: none
  VectorShape shape = VectorShape::kNone;
  /// One for a point, several for a line: longitude and latitude [degrees], or coordinates of a
  /// flat system.
  std::vector<Eigen::Vector2d> points;
};

struct VectorLayer {
  std::string name;
  std::string crs;             ///< empty: none, or one that is not tied to the earth
  std::string overruled_crs;   ///< what the file states, if the options state otherwise
  bool is_geographic = false;  ///< points are longitude and latitude (WGS 84)
  bool has_geometry = true;    ///< false: a table
  std::vector<std::string> fields;
  std::vector<VectorFeature> features;

  bool has(std::string_view field) const;
  /// The text of a feature's field; empty if there is none.
  std::string text(const VectorFeature& feature, std::string_view field) const;
};

/// Throws FileError unless a layer of `path` has a position on the earth if the map has one.
void require_frame_of(const VectorLayer& layer, const std::string& path,
                      const std::optional<geometry::Georeference>& georeference);

/// The point of a feature in the frame of the map. Throws FileError that begins with `at`.
Eigen::Vector2d place_in_map(const VectorFeature& feature, const std::string& at,
                             const std::optional<geometry::Georeference>& georeference);

struct VectorFile {
  std::string driver;
  std::map<std::string, std::string> metadata;
  std::vector<std::string> layer_names;  ///< of all layers
  std::vector<VectorLayer> layers;       ///< those that were read

  /// KML and DXF: all layers belong to one drawing.
  bool is_drawing() const { return driver == "LIBKML" || driver == "KML" || driver == "DXF"; }
};

struct VectorFileOptions {
  std::vector<std::string> drivers;  ///< of GDAL; no other is tried
  std::string formats;               ///< their names, for messages: "a GeoPackage"
  std::vector<std::string> layers;   ///< to read; none: the only one, or all of a drawing
  std::string crs;                   ///< in place of the file's, such as EPSG:25830
  double widest_symbol_m = 0.0;      ///< a closed line of a DXF up to this width is its middle
};

/// Reads a file of points and lines by GDAL, in a process that opens no connection and whose memory
/// and time are limited by the file's size (confined.hpp). Throws FileError naming the file and the
/// feature.
VectorFile read_vector_file(const std::string& path, const VectorFileOptions& options);

/// From a coordinate system to longitude and latitude of WGS 84 [degrees].
class ToDegrees {
 public:
  /// `crs`: as the user names it. Throws FileError.
  explicit ToDegrees(const std::string& crs);
  explicit ToDegrees(std::unique_ptr<OGRCoordinateTransformation> transformation);
  ~ToDegrees();
  ToDegrees(ToDegrees&&) noexcept;

  /// False for a point outside the system's area.
  bool convert(Eigen::Vector2d& p) const;

 private:
  std::unique_ptr<OGRCoordinateTransformation> transformation_;
};

}  // namespace orchard::io
