// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/vector_file.hpp"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_srs_api.h>
#include <ogrsf_frmts.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "io/byte_fields.hpp"
#include "io/confined.hpp"
#include "io/file_error.hpp"
#include "io/gis/gdal_errors.hpp"
#include "io/sane_limits.hpp"

namespace orchard::io {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kNumFeaturesMax = 2000000;
constexpr int kNumPointsMax = 100000;  ///< per line

std::string crs_text(const OGRSpatialReference& srs) {
  const char* authority = srs.GetAuthorityName(nullptr);
  const char* code = srs.GetAuthorityCode(nullptr);
  if (authority != nullptr && code != nullptr) return std::string(authority) + ":" + code;
  return srs.GetName() != nullptr ? srs.GetName() : "unnamed";
}

std::unique_ptr<OGRSpatialReference> named_crs(const std::string& name) {
  auto srs = std::make_unique<OGRSpatialReference>();
  const CSLConstList limits = OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get();
  if (srs->SetFromUserInput(name.c_str(), limits) != OGRERR_NONE) {
    throw FileError("--crs " + name +
                    " is not a coordinate system; give a code such as EPSG:25830");
  }
  return srs;
}

std::unique_ptr<OGRCoordinateTransformation> to_wgs84(OGRSpatialReference& srs) {
  OGRSpatialReference wgs84;
  wgs84.importFromEPSG(4326);
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return std::unique_ptr<OGRCoordinateTransformation>(
      OGRCreateCoordinateTransformation(&srs, &wgs84));
}

/// Stored bytes, without the holes of a sparse file.
std::uint64_t stored_bytes(const std::filesystem::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return 0;
  constexpr std::uint64_t kBlockBytes = 512;  // physical: stat(2)
  return std::min(static_cast<std::uint64_t>(status.st_size),
                  kBlockBytes * static_cast<std::uint64_t>(status.st_blocks));
}

// derived: twice the ratio of 100,000 trees in a regular grid as KML, 34.
constexpr std::uint64_t kUnpackedPerPacked = 64;

/// What the files of a zip archive have together, as it states.
std::uint64_t unpacked_bytes(const std::string& path, std::uint64_t packed_bytes) {
  const std::string archive = "/vsizip/{" + path + "}";
  const auto read = [&] {
    std::uint64_t bytes = 0;
    const CPLStringList names(VSIReadDirRecursive(archive.c_str()));
    for (int i = 0; i < names.size(); ++i) {
      VSIStatBufL status{};
      const bool is_there = VSIStatL((archive + "/" + names[i]).c_str(), &status) == 0;
      if (is_there) bytes += static_cast<std::uint64_t>(status.st_size);
    }
    return std::to_string(bytes);
  };
  const std::string digits = read_confined(path, packed_bytes, read);
  std::uint64_t bytes = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), bytes);
  if (bytes <= kUnpackedPerPacked * packed_bytes) return bytes;
  throw FileError(path + " has " + std::to_string(packed_bytes) + " bytes and unpacks to " +
                  digits + ": no file of trees does so; it is made to exhaust who reads it");
}

/// Of the file, unpacked, and what GDAL opens by its name: block.shp with block.dbf and its like.
std::uint64_t bytes_of(const std::string& path) {
  const std::filesystem::path file(path);
  std::uint64_t bytes = stored_bytes(file);
  if (file.extension() == ".kmz" || file.extension() == ".zip" || file.extension() == ".shz") {
    bytes = std::max(bytes, unpacked_bytes(path, bytes));
  }
  if (file.extension() != ".shp") return bytes;
  for (const char* extension : {".shx", ".dbf"}) {
    bytes += stored_bytes(std::filesystem::path(file).replace_extension(extension));
  }
  return bytes;
}

/// Reads a file inside the confined process.
class ConfinedReader {
 public:
  ConfinedReader(const std::string& path, std::uint64_t file_bytes,
                 const VectorFileOptions& options)
      : path_(path), file_bytes_(file_bytes), options_(options) {
    OSRSetPROJEnableNetwork(FALSE);
    GDALAllRegister();
    std::vector<const char*> drivers;
    for (const std::string& driver : options.drivers) drivers.push_back(driver.c_str());
    drivers.push_back(nullptr);
    dataset_.reset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY,
                                     drivers.data(), nullptr, nullptr));
    if (!dataset_) {
      throw FileError(path + " is not " + options.formats +
                      (errors_.first().empty() ? "" : " (" + errors_.first() + ")"));
    }
    driver_ = dataset_->GetDriver()->GetDescription();
  }

  std::string read() {
    out_ += text_bytes(driver_);
    put_metadata();
    out_ += number_bytes(static_cast<std::uint32_t>(dataset_->GetLayerCount()));
    for (OGRLayer* layer : dataset_->GetLayers()) out_ += text_bytes(layer->GetName());
    for (OGRLayer* layer : dataset_->GetLayers()) {
      if (is_wanted(*layer)) put_layer(*layer);
    }
    out_ += number_bytes(kEnd);
    if (!errors_.first().empty()) {
      throw FileError(path_ + " could not be read completely (" + errors_.first() +
                      "); a file is read without what it links to");
    }
    return std::move(out_);
  }

  static constexpr std::uint8_t kMore = 1, kEnd = 0;

 private:
  bool is_wanted(OGRLayer& layer) const {
    const auto& names = options_.layers;
    if (!names.empty())
      return std::find(names.begin(), names.end(), layer.GetName()) != names.end();
    const VectorFile kind{driver_, {}, {}, {}};
    return kind.is_drawing() || dataset_->GetLayerCount() == 1;
  }

  void put_metadata() {
    const char* const* all = dataset_->GetMetadata();
    out_ += number_bytes(static_cast<std::uint32_t>(CSLCount(all)));
    for (int i = 0; i < CSLCount(all); ++i) out_ += text_bytes(all[i]);
  }

  void put_layer(OGRLayer& layer) {
    const OGRFeatureDefn& definition = *layer.GetLayerDefn();
    out_ += number_bytes(kMore);
    out_ += text_bytes(layer.GetName());
    put_crs(layer);
    out_ += number_bytes(static_cast<std::uint8_t>(definition.GetGeomFieldCount() > 0));
    out_ += number_bytes(static_cast<std::uint32_t>(definition.GetFieldCount()));
    for (int i = 0; i < definition.GetFieldCount(); ++i) {
      out_ += text_bytes(definition.GetFieldDefn(i)->GetNameRef());
    }
    layer.ResetReading();
    for (std::int64_t number = 1;; ++number) {
      const OGRFeatureUniquePtr feature(layer.GetNextFeature());
      if (!feature) break;
      if (++num_features_ > kNumFeaturesMax) {
        throw FileError(path_ + " has over two million features; give the plan of one block");
      }
      // The shortest feature, `1,2` in a table, has four bytes.
      if (num_features_ > file_bytes_) {
        throw FileError(path_ + " makes over " + std::to_string(file_bytes_) +
                        " features of as many bytes: it is made to exhaust who reads it");
      }
      at_ = path_ + ": feature " + std::to_string(number) + " of layer " + layer.GetName();
      put_feature(*feature);
    }
    out_ += number_bytes(kEnd);
  }

  void put_crs(OGRLayer& layer) {
    to_degrees_.reset();
    std::unique_ptr<OGRSpatialReference> srs;
    if (const OGRSpatialReference* own = layer.GetSpatialRef()) srs.reset(own->Clone());
    if (srs && (srs->IsLocal() || (!srs->IsGeographic() && !srs->IsProjected()))) srs.reset();
    std::string overruled;
    if (!options_.crs.empty()) {
      auto given = named_crs(options_.crs);
      given->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
      if (srs) srs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
      if (srs && !srs->IsSame(given.get())) overruled = crs_text(*srs);
      srs = std::move(given);
    }
    crs_ = srs ? crs_text(*srs) : "";
    out_ += text_bytes(crs_);
    out_ += text_bytes(overruled);
    if (!srs) return;
    auto transformation = to_wgs84(*srs);
    if (!transformation) {
      throw FileError(path_ + ": " + crs_ + " cannot be converted to latitude and longitude");
    }
    to_degrees_.emplace(std::move(transformation));
  }

  void put_feature(const OGRFeature& feature) {
    out_ += number_bytes(kMore);
    out_ += number_bytes(static_cast<std::int64_t>(feature.GetFID()));
    for (int i = 0; i < feature.GetFieldCount(); ++i) out_ += text_bytes(value_of(feature, i));
    VectorShape shape = VectorShape::kNone;
    points_.clear();
    const OGRGeometry* geometry = feature.GetGeometryRef();
    if (geometry != nullptr && !geometry->IsEmpty()) shape = take(*geometry);
    out_ += number_bytes(shape);
    out_ += number_bytes(static_cast<std::uint32_t>(points_.size()));
    for (Vector2d& p : points_) {
      if (to_degrees_ && !to_degrees_->convert(p)) {
        throw FileError(at_ + " is outside the area of " + crs_);
      }
      out_ += number_bytes(p.x());
      out_ += number_bytes(p.y());
    }
  }

  /// Text of a field; a number with all its digits.
  static std::string value_of(const OGRFeature& feature, int field) {
    if (!feature.IsFieldSetAndNotNull(field)) return {};
    if (feature.GetFieldDefnRef(field)->GetType() != OFTReal) {
      return feature.GetFieldAsString(field);
    }
    std::array<char, 64> text{};
    const auto end = std::to_chars(text.begin(), text.end(), feature.GetFieldAsDouble(field)).ptr;
    return {text.data(), end};
  }

  /// Collects the points of a geometry in the file's system.
  VectorShape take(const OGRGeometry& geometry) {
    const auto flat = wkbFlatten(geometry.getGeometryType());
    if (flat == wkbPoint) {
      points_ = {{geometry.toPoint()->getX(), geometry.toPoint()->getY()}};
      return VectorShape::kPoint;
    }
    if (flat == wkbMultiPoint || flat == wkbMultiLineString || flat == wkbGeometryCollection) {
      const OGRGeometryCollection* parts = geometry.toGeometryCollection();
      return parts->getNumGeometries() == 1 ? take(*parts->getGeometryRef(0)) : VectorShape::kOther;
    }
    return flat == wkbLineString ? take_line(*geometry.toLineString()) : VectorShape::kOther;
  }

  VectorShape take_line(const OGRLineString& line) {
    if (line.getNumPoints() < 2) return VectorShape::kOther;
    if (line.getNumPoints() > kNumPointsMax) {
      throw FileError(at_ + " is a line of over " + std::to_string(kNumPointsMax) + " points");
    }
    if (driver_ == "DXF" && line.get_IsClosed()) {
      OGREnvelope box;
      line.getEnvelope(&box);
      const double width_m = std::max(box.MaxX - box.MinX, box.MaxY - box.MinY);
      if (width_m > options_.widest_symbol_m) return VectorShape::kOther;
      points_ = {{0.5 * (box.MinX + box.MaxX), 0.5 * (box.MinY + box.MaxY)}};
      return VectorShape::kPoint;
    }
    for (int i = 0; i < line.getNumPoints(); ++i) points_.emplace_back(line.getX(i), line.getY(i));
    return VectorShape::kLine;
  }

  const std::string& path_;
  const std::uint64_t file_bytes_;
  const VectorFileOptions& options_;
  GdalErrors errors_;
  // insert blocks of a drawing (a tree's symbol) as points
  CPLConfigOptionSetter symbols_as_points_{"DXF_INLINE_BLOCKS", "FALSE", false};
  CPLConfigOptionSetter no_styles_{"LIBKML_RESOLVE_STYLE", "NO", false};
  CPLConfigOptionSetter no_extensions_{"OGR_SQLITE_LOAD_EXTENSIONS", nullptr, false};
  GDALDatasetUniquePtr dataset_;
  std::optional<ToDegrees> to_degrees_;
  std::string driver_, crs_, at_;
  std::vector<Vector2d> points_;
  std::size_t num_features_ = 0;
  std::string out_;  ///< the bytes that the confined process hands over; file_of() reads them
};

VectorFeature feature_of(ByteFields& in, std::size_t num_fields) {
  VectorFeature feature;
  feature.number = in.number<std::int64_t>();
  for (std::size_t i = 0; i < num_fields && in.ok(); ++i) feature.values.push_back(in.text());
  feature.shape = in.number<VectorShape>();
  const auto num_points = in.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < num_points && in.ok(); ++i) {
    const auto x = in.number<double>();
    feature.points.emplace_back(x, in.number<double>());
  }
  return feature;
}

VectorLayer layer_of(ByteFields& in) {
  VectorLayer layer;
  layer.name = in.text();
  layer.crs = in.text();
  layer.overruled_crs = in.text();
  layer.is_geographic = !layer.crs.empty();
  layer.has_geometry = in.number<std::uint8_t>() != 0;
  const auto num_fields = in.number<std::uint32_t>();
  for (std::uint32_t i = 0; i < num_fields && in.ok(); ++i) layer.fields.push_back(in.text());
  while (in.number<std::uint8_t>() == ConfinedReader::kMore && in.ok()) {
    layer.features.push_back(feature_of(in, layer.fields.size()));
  }
  return layer;
}

VectorFile file_of(const std::string& bytes, const std::string& path) {
  ByteFields in(bytes);
  VectorFile file;
  file.driver = in.text();
  for (auto left = in.number<std::uint32_t>(); left > 0 && in.ok(); --left) {
    const std::string pair = in.text();
    const std::size_t equals = std::min(pair.find('='), pair.size());
    file.metadata[pair.substr(0, equals)] = pair.substr(std::min(equals + 1, pair.size()));
  }
  for (auto left = in.number<std::uint32_t>(); left > 0 && in.ok(); --left) {
    file.layer_names.push_back(in.text());
  }
  while (in.number<std::uint8_t>() == ConfinedReader::kMore && in.ok()) {
    file.layers.push_back(layer_of(in));
  }
  if (!in.ok() || in.left() > 0) throw FileError(path + ": its reader ended before its end");
  return file;
}

}  // namespace

VectorFile read_vector_file(const std::string& path, const VectorFileOptions& options) {
  const std::uint64_t file_bytes = bytes_of(path);
  const auto read = [&] { return ConfinedReader(path, file_bytes, options).read(); };
  return file_of(read_confined(path, file_bytes, read), path);
}

bool VectorLayer::has(std::string_view field) const {
  return std::find(fields.begin(), fields.end(), field) != fields.end();
}

std::string VectorLayer::text(const VectorFeature& feature, std::string_view field) const {
  const auto found = std::find(fields.begin(), fields.end(), field);
  if (found == fields.end()) return {};
  return feature.values[static_cast<std::size_t>(found - fields.begin())];
}

void require_frame_of(const VectorLayer& layer, const std::string& path,
                      const std::optional<geometry::Georeference>& georeference) {
  if (layer.is_geographic == georeference.has_value()) return;
  throw FileError(path +
                  (layer.is_geographic
                       ? " has a position on the earth, but the map is not georeferenced"
                       : " has no position on the earth, but the map has") +
                  "; give a file that was exported from this map");
}

Vector2d place_in_map(const VectorFeature& feature, const std::string& at,
                      const std::optional<geometry::Georeference>& georeference) {
  if (feature.shape != VectorShape::kPoint) {
    throw FileError(at + " is not a point; correct or delete it");
  }
  Vector2d p = feature.points.front();
  if (georeference) p = geometry::map_of(*georeference, {p.y(), p.x()});
  if (p.cwiseAbs().maxCoeff() <= kMaxCoordinate_m) return p;
  throw FileError(at + " is farther away than a map can reach");
}

ToDegrees::ToDegrees(const std::string& crs) : transformation_(to_wgs84(*named_crs(crs))) {
  if (!transformation_) {
    throw FileError("--crs " + crs + " cannot be converted to latitude and longitude");
  }
}
ToDegrees::ToDegrees(std::unique_ptr<OGRCoordinateTransformation> transformation)
    : transformation_(std::move(transformation)) {}
ToDegrees::~ToDegrees() = default;
ToDegrees::ToDegrees(ToDegrees&&) noexcept = default;

bool ToDegrees::convert(Vector2d& p) const {
  return transformation_->Transform(1, &p.x(), &p.y()) != 0;
}

}  // namespace orchard::io
