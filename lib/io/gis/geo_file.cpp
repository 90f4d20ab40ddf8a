// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/geo_file.hpp"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>

#include "io/file_error.hpp"
#include "io/gis/gdal_errors.hpp"
#include "io/gis/geopackage.hpp"

namespace orchard::io {
namespace {

/// A file in memory, deleted with this object.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& extension) {
    static std::atomic<unsigned> counter{0};
    folder_ = "/vsimem/orchard-" + std::to_string(::getpid()) + "-" + std::to_string(counter++);
    path_ = folder_ + "/map" + extension;
    VSIMkdir(folder_.c_str(), 0700);  // required by the CSV driver
  }
  ~MemoryFile() { VSIRmdirRecursive(folder_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& path() const { return path_; }
  std::string bytes() const { return bytes_of(path_); }
  /// The files that GDAL wrote beside it, by extension.
  std::map<std::string, std::string> others() const {
    std::map<std::string, std::string> others;
    const CPLStringList names(VSIReadDir(folder_.c_str()));
    for (int i = 0; i < names.Count(); ++i) {
      const std::string path = folder_ + "/" + names[i];
      const std::size_t dot = path.rfind('.');
      if (path != path_ && dot != std::string::npos) others[path.substr(dot)] = bytes_of(path);
    }
    return others;
  }

 private:
  static std::string bytes_of(const std::string& path) {
    vsi_l_offset size = 0;
    const GByte* data = VSIGetMemFileBuffer(path.c_str(), &size, FALSE);
    return data == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(data), size);
  }

  std::string folder_;
  std::string path_;
};

constexpr char kShapefileLoses[] =
    "a Shapefile limits column names to ten letters and texts to 254 bytes";

OGRFieldType ogr_type(GeoType type) {
  constexpr OGRFieldType kTypes[] = {OFTInteger, OFTInteger64, OFTReal, OFTString};
  return kTypes[static_cast<std::size_t>(type)];
}

}  // namespace

const std::vector<GeoFormatInfo>& geo_formats() {
  static const std::vector<GeoFormatInfo> kFormats{
      {GeoFormat::kGeoPackage, "gpkg", ".gpkg", "GPKG", false, false, ""},
      {GeoFormat::kGeoJson, "geojson", ".geojson", "GeoJSON", true, true, ""},
      {GeoFormat::kKml, "kml", ".kml", "KML", false, true, "KML does not store colours by class"},
      {GeoFormat::kShapefile, "shp", ".shp.zip", "ESRI Shapefile", false, false, kShapefileLoses},
      {GeoFormat::kShapefileParts, "shp", ".shp", "ESRI Shapefile", true, false, kShapefileLoses},
      {GeoFormat::kDxf, "dxf", ".dxf", "DXF", false, false,
       "DXF stores only positions and labels: no widths, no certainty, no coordinate system"},
      {GeoFormat::kCsv, "csv", ".csv", "CSV", true, false,
       "CSV does not store the coordinate system"},
      {GeoFormat::kFlatGeobuf, "flatgeobuf", ".fgb", "FlatGeobuf", true, false, ""},
      {GeoFormat::kGpx, "gpx", ".gpx", "GPX", true, true, ""},
      {GeoFormat::kRouteGraph, "nav2", ".geojson", "", true, false, ""},
      {GeoFormat::kTopologicalMap, "tmap2", ".yaml", "", true, false, ""},
      {GeoFormat::kOccupancyGrid, "grid", ".yaml", "", true, false, ""},
      {GeoFormat::kKitti, "kitti", ".txt", "", true, false, "KITTI's form has no times"}};
  return kFormats;
}

std::string geo_system_text(const std::optional<geometry::Georeference>& georeference,
                            const GeoFormatInfo& format) {
  if (!georeference) return "metres of the map, not georeferenced";
  if (format.is_on_earth) return "WGS 84, latitude and longitude (EPSG:4326)";
  const std::string utm =
      "WGS 84 in UTM (EPSG:" + std::to_string(geometry::utm_epsg(*georeference)) + ")";
  if (format.format != GeoFormat::kCsv) return utm;
  return "x_m and y_m in metres of the map, latitude_deg and longitude_deg of WGS 84 (EPSG:4326); "
         "WKT " +
         utm;
}

namespace {

/// A file written by GDAL.
class OgrFile final : public LayerFile {
 public:
  OgrFile(const std::optional<geometry::Georeference>& georeference, const GeoFormatInfo& info);
  std::string finish() override;
  std::map<std::string, std::string> companions() const override {
    return info_.format == GeoFormat::kShapefileParts ? file_.others()
                                                      : std::map<std::string, std::string>();
  }

 protected:
  void open_layer(const GeoLayer& layer) override;
  void write_feature(const std::vector<GeoValue>& values,
                     const std::vector<Eigen::Vector2d>& points_map,
                     const std::optional<double>& height_m) override;

 private:
  void require(bool holds) const {
    if (holds && errors_.first().empty()) return;
    throw SystemError(std::string("map") + info_.extension + ": GDAL cannot write it (" +
                      (errors_.first().empty() ? std::string("no reason given") : errors_.first()) +
                      "); install GDAL with its " + info_.driver + " driver?");
  }
  /// KML and GPX want heights above the sea, which the ellipsoid is not.
  bool has_heights() const {
    return begun_.has_heights && info_.format != GeoFormat::kKml && info_.format != GeoFormat::kGpx;
  }
  OGRPoint point_of(const Eigen::Vector2d& p_map) const {
    if (georeference_ && info_.is_on_earth) {
      const geometry::Geodetic place = geometry::geodetic_of(*georeference_, p_map);
      return OGRPoint(stored_value(place.longitude_deg), stored_value(place.latitude_deg));
    }
    const Eigen::Vector2d p = georeference_ ? geometry::utm_of(*georeference_, p_map) : p_map;
    return OGRPoint(stored_m(p.x()), stored_m(p.y()));
  }
  void set_values(const std::vector<GeoValue>& values, OGRFeature& feature) const;
  void add_drawing(const std::vector<GeoValue>& values, const OGRGeometry& geometry);

  std::optional<geometry::Georeference> georeference_;
  const GeoFormatInfo& info_;
  CPLConfigOptionSetter no_hatch_{"DXF_WRITE_HATCH", "NO", false};  // an outline only
  GdalErrors errors_;
  MemoryFile file_;
  OGRSpatialReference srs_;
  std::unique_ptr<GDALDataset> dataset_;
  OGRLayer* layer_ = nullptr;
  GeoLayer begun_{};         ///< the current layer
  std::vector<int> fields_;  ///< of the layer, by the field of begun_
  bool is_table_ = false;    ///< coordinates are columns, no geometry is written
};

OgrFile::OgrFile(const std::optional<geometry::Georeference>& georeference,
                 const GeoFormatInfo& info)
    : LayerFile(info.has_one_layer),
      georeference_(georeference),
      info_(info),
      file_(info.extension) {
  GDALAllRegister();
  if (info.is_on_earth && !georeference) {
    throw FileError(std::string(info.word) +
                    " stores only latitude and longitude, but the map is not georeferenced (no "
                    "GNSS, no pose.gnss.datum); use gpkg, shp, dxf or csv");
  }
  if (georeference) {
    const int epsg = info.is_on_earth ? 4326 : geometry::utm_epsg(*georeference);
    require(srs_.importFromEPSG(epsg) == OGRERR_NONE);
  } else {
    require(srs_.importFromWkt(kLocalSystem) == OGRERR_NONE);
  }
  srs_.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(info.driver);
  require(driver != nullptr);
  CPLStringList options;
  if (info.format == GeoFormat::kGpx) options.SetNameValue("GPX_USE_EXTENSIONS", "YES");
  if (info.format == GeoFormat::kKml) options.SetNameValue("NameField", "label");
  dataset_.reset(driver->Create(file_.path().c_str(), 0, 0, 0, GDT_Unknown, options.List()));
  require(dataset_ != nullptr);
}

void OgrFile::open_layer(const GeoLayer& layer) {
  begun_ = layer;
  const bool is_drawing = info_.format == GeoFormat::kDxf;
  if (is_drawing && dataset_->GetLayerCount() > 0) {  // one for all: a feature names its own
    layer_ = dataset_->GetLayer(0);
    return;
  }
  const auto has_place = [](const GeoField& field) { return field.name == std::string("x_m"); };
  is_table_ = info_.format == GeoFormat::kCsv &&
              std::any_of(layer.fields.begin(), layer.fields.end(), has_place);
  CPLStringList options;
  if (info_.format == GeoFormat::kGeoJson) {
    options.SetNameValue("RFC7946", "YES");
    options.SetNameValue("COORDINATE_PRECISION", "9");  // a tenth of a millimetre
    options.SetNameValue("DESCRIPTION", layer.description);
  } else if (info_.format == GeoFormat::kGpx) {
    options.SetNameValue("FORCE_GPX_TRACK", "YES");
  } else if (info_.driver == std::string("ESRI Shapefile")) {
    options.SetNameValue("ENCODING", "UTF-8");
  } else if (info_.format == GeoFormat::kCsv && !is_table_) {
    options.SetNameValue("GEOMETRY", "AS_WKT");
  }
  const auto type = is_table_                               ? wkbNone
                    : has_heights()                         ? wkbPoint25D
                    : layer.geometry == GeoGeometry::kPoint ? wkbPoint
                    : layer.geometry == GeoGeometry::kArea  ? wkbPolygon
                                                            : wkbLineString;
  layer_ = dataset_->CreateLayer(layer.name, is_drawing || is_table_ ? nullptr : &srs_,
                                 is_drawing ? wkbUnknown : type, options.List());
  require(layer_ != nullptr);
  fields_.clear();
  if (is_drawing) return;  // its fields are fixed by the format
  for (const GeoField& field : layer.fields) {
    // What receivers show of a waypoint is its name, a field that GPX has already.
    const bool is_name = info_.format == GeoFormat::kGpx && field.name == std::string("label");
    fields_.push_back(is_name ? layer_->GetLayerDefn()->GetFieldIndex("name") : -1);
    if (is_name) continue;
    OGRFieldDefn definition(field.name, ogr_type(field.type));
    require(layer_->CreateField(&definition) == OGRERR_NONE);
    fields_.back() = layer_->GetLayerDefn()->GetFieldCount() - 1;
  }
}

void OgrFile::set_values(const std::vector<GeoValue>& values, OGRFeature& feature) const {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const int field = fields_[i];
    switch (values[i].kind) {
      case GeoValue::Kind::kNone:
        // A GeoJSON has the columns that its features name: an empty one can then be filled in.
        if (info_.format == GeoFormat::kGeoJson) feature.SetFieldNull(field);
        break;
      case GeoValue::Kind::kInteger:
        feature.SetField(field, static_cast<GIntBig>(values[i].integer));
        break;
      case GeoValue::Kind::kReal:
        feature.SetField(field, stored_value(values[i].real));
        break;
      case GeoValue::Kind::kText:
        feature.SetField(field, values[i].text.c_str());
        break;
    }
  }
}

/// A drawing has no columns: the kind becomes the layer name, the label a text beside it.
void OgrFile::add_drawing(const std::vector<GeoValue>& values, const OGRGeometry& geometry) {
  std::string layer_name = begun_.name, label;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (begun_.fields[i].name == std::string("kind")) layer_name = values[i].text;
    if (begun_.fields[i].name == std::string("label")) label = values[i].text;
  }
  OGRFeature feature(layer_->GetLayerDefn());
  feature.SetField("Layer", layer_name.c_str());
  feature.SetGeometry(&geometry);
  require(layer_->CreateFeature(&feature) == OGRERR_NONE);
  if (label.empty() || wkbFlatten(geometry.getGeometryType()) != wkbPoint) return;
  std::replace(label.begin(), label.end(), '"', ' ');
  OGRFeature text(layer_->GetLayerDefn());
  text.SetField("Layer", (layer_name + " labels").c_str());
  text.SetGeometry(&geometry);
  text.SetStyleString(("LABEL(f:\"Arial\",s:0.3g,t:\"" + label + "\")").c_str());
  require(layer_->CreateFeature(&text) == OGRERR_NONE);
}

void OgrFile::write_feature(const std::vector<GeoValue>& values,
                            const std::vector<Eigen::Vector2d>& points_map,
                            const std::optional<double>& height_m) {
  OGRLineString line;
  for (const Eigen::Vector2d& p : points_map) {
    const OGRPoint point = point_of(p);
    line.addPoint(&point);
  }
  OGRPoint point;
  if (points_map.size() == 1) line.getPoint(0, &point);
  if (height_m && has_heights()) point.setZ(stored_m(*height_m));
  OGRPolygon area;
  if (begun_.geometry == GeoGeometry::kArea) {
    OGRLinearRing border;
    border.addSubLineString(&line);
    border.closeRings();
    area.addRing(&border);
  }
  const OGRGeometry& geometry = points_map.size() == 1 ? static_cast<const OGRGeometry&>(point)
                                : area.IsEmpty()       ? static_cast<const OGRGeometry&>(line)
                                                       : area;
  if (info_.format == GeoFormat::kDxf) {
    add_drawing(values, geometry);
    return;
  }
  OGRFeature feature(layer_->GetLayerDefn());
  set_values(values, feature);
  if (!is_table_) feature.SetGeometry(&geometry);
  require(layer_->CreateFeature(&feature) == OGRERR_NONE);
}

std::string OgrFile::finish() {
  dataset_.reset();
  std::string bytes = file_.bytes();
  require(!bytes.empty());
  return bytes;
}

}  // namespace

std::unique_ptr<LayerFile> geo_file(const std::optional<geometry::Georeference>& georeference,
                                    GeoFormat format) {
  if (format == GeoFormat::kGeoPackage) return std::make_unique<GeoPackage>(georeference);
  const auto& formats = geo_formats();
  return std::make_unique<OgrFile>(
      georeference, *std::find_if(formats.begin(), formats.end(),
                                  [format](const auto& f) { return f.format == format; }));
}

}  // namespace orchard::io
