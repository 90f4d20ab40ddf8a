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

namespace orchard::io {
namespace {

/// Without this, GDAL writes the time of day into a GeoPackage.
constexpr char kFixedDate[] = "2000-01-01T00:00:00.000Z";

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
  std::string bytes() const {
    vsi_l_offset size = 0;
    const GByte* data = VSIGetMemFileBuffer(path_.c_str(), &size, FALSE);
    return data == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(data), size);
  }

 private:
  std::string folder_;
  std::string path_;
};

OGRFieldType ogr_type(GeoType type) {
  switch (type) {
    case GeoType::kInteger:
      return OFTInteger;
    case GeoType::kInteger64:
      return OFTInteger64;
    case GeoType::kReal:
      return OFTReal;
    case GeoType::kText:
      break;
  }
  return OFTString;
}

/// With axes, so that every program treats it as a plane in metres.
constexpr char kLocalSystem[] =
    "LOCAL_CS[\"Orchard map (local)\",LOCAL_DATUM[\"Where the first drive began\",0],"
    "UNIT[\"metre\",1],AXIS[\"x\",EAST],AXIS[\"y\",NORTH]]";

/// Name of the driver in GDAL.
const char* driver_of(GeoFormat format) {
  switch (format) {
    case GeoFormat::kGeoPackage:
      return "GPKG";
    case GeoFormat::kGeoJson:
      return "GeoJSON";
    case GeoFormat::kKml:
      return "LIBKML";
    case GeoFormat::kShapefile:
      return "ESRI Shapefile";
    case GeoFormat::kDxf:
      return "DXF";
    case GeoFormat::kCsv:
      return "CSV";
    case GeoFormat::kFlatGeobuf:
      break;
  }
  return "FlatGeobuf";
}

}  // namespace

const std::vector<GeoFormatInfo>& geo_formats() {
  static const std::vector<GeoFormatInfo> kFormats{
      {GeoFormat::kGeoPackage, "gpkg", ".gpkg", false, false, ""},
      {GeoFormat::kGeoJson, "geojson", ".geojson", true, true, ""},
      {GeoFormat::kKml, "kml", ".kml", false, true, "KML does not store colours by class"},
      {GeoFormat::kShapefile, "shp", ".shp.zip", false, false,
       "a Shapefile limits column names to ten letters and texts to 254 bytes"},
      {GeoFormat::kDxf, "dxf", ".dxf", false, false,
       "DXF stores only positions and labels: no widths, no certainty, no coordinate system"},
      {GeoFormat::kCsv, "csv", ".csv", true, false, "CSV does not store the coordinate system"},
      {GeoFormat::kFlatGeobuf, "flatgeobuf", ".fgb", true, false, ""}};
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

struct GeoFile::Impl {
  Impl(const std::optional<geometry::Georeference>& g, const GeoFormatInfo& f)
      : georeference(g), info(f), file(f.extension) {}

  void require(bool holds) const {
    if (holds && errors.first().empty()) return;
    throw FileError(std::string("map") + info.extension + ": GDAL cannot write it (" +
                    (errors.first().empty() ? std::string("no reason given") : errors.first()) +
                    "); install GDAL with its " + driver_of(info.format) + " driver?");
  }
  OGRPoint point(const Eigen::Vector2d& p_map) const {
    if (!georeference) return OGRPoint(p_map.x(), p_map.y());
    if (info.is_on_earth) {
      const geometry::Geodetic place = geometry::geodetic_of(*georeference, p_map);
      return OGRPoint(place.longitude_deg, place.latitude_deg);
    }
    const Eigen::Vector2d p = geometry::utm_of(*georeference, p_map);
    return OGRPoint(p.x(), p.y());
  }
  void set_values(const std::vector<GeoValue>& values, OGRFeature& feature) const;
  void add_drawing(const std::vector<GeoValue>& values, const OGRGeometry& geometry);
  void write_styles();

  std::optional<geometry::Georeference> georeference;
  const GeoFormatInfo& info;
  CPLConfigOptionSetter fixed_date{"OGR_CURRENT_DATE", kFixedDate, false};
  CPLConfigOptionSetter label_field{"LIBKML_NAME_FIELD", "label", false};
  CPLConfigOptionSetter no_hatch{"DXF_WRITE_HATCH", "NO", false};  // an outline only
  GdalErrors errors;
  MemoryFile file;
  OGRSpatialReference srs;
  std::unique_ptr<GDALDataset> dataset;
  OGRLayer* layer = nullptr;  ///< null: omitted
  GeoLayer begun{};           ///< the current layer
  bool is_table = false;      ///< coordinates are columns, no geometry is written
  std::string chosen;         ///< empty: all, or the first of a format with one layer
  std::vector<std::string> left_out;
  std::vector<std::pair<std::string, std::size_t>> written;
  std::vector<GeoLayer> styled;
};

GeoFile::GeoFile(const std::optional<geometry::Georeference>& georeference, GeoFormat format) {
  GDALAllRegister();
  const auto& formats = geo_formats();
  const auto info = std::find_if(formats.begin(), formats.end(),
                                 [format](const auto& f) { return f.format == format; });
  impl_ = std::make_unique<Impl>(georeference, *info);
  Impl& m = *impl_;
  if (info->is_on_earth && !georeference) {
    throw FileError(std::string(info->word) +
                    " stores only latitude and longitude, but the map is not georeferenced (no "
                    "GNSS, no pose.gnss.datum); use gpkg, shp, dxf or csv");
  }
  if (georeference) {
    const int epsg = info->is_on_earth ? 4326 : geometry::utm_epsg(*georeference);
    m.require(m.srs.importFromEPSG(epsg) == OGRERR_NONE);
  } else {
    m.require(m.srs.importFromWkt(kLocalSystem) == OGRERR_NONE);
  }
  m.srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(driver_of(format));
  m.require(driver != nullptr);
  m.dataset.reset(driver->Create(m.file.path().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  m.require(m.dataset != nullptr);
  if (m.dataset->TestCapability(ODsCTransactions)) {
    m.require(m.dataset->StartTransaction() == OGRERR_NONE);
  }
}

GeoFile::~GeoFile() = default;

void GeoFile::choose_layer(const std::string& name) { impl_->chosen = name; }

const std::vector<std::string>& GeoFile::left_out() const { return impl_->left_out; }

const std::vector<std::pair<std::string, std::size_t>>& GeoFile::written() const {
  return impl_->written;
}

void GeoFile::set_metadata(const char* name, const std::string& value) {
  Impl& m = *impl_;
  if (m.info.format != GeoFormat::kGeoPackage) return;
  m.require(m.dataset->SetMetadataItem(name, value.c_str()) == CE_None);
}

void GeoFile::begin_layer(const GeoLayer& layer) {
  Impl& m = *impl_;
  m.begun = layer;
  const bool is_drawing = m.info.format == GeoFormat::kDxf;
  const bool is_chosen =
      m.chosen.empty() ? !m.info.has_one_layer || m.written.empty() : m.chosen == layer.name;
  if (!is_chosen) {
    m.layer = nullptr;
    m.left_out.push_back(layer.name);
    return;
  }
  m.written.emplace_back(layer.name, 0);
  if (is_drawing && m.dataset->GetLayerCount() > 0) {  // one for all: a feature names its own
    m.layer = m.dataset->GetLayer(0);
    return;
  }
  const auto has_place = [](const GeoField& field) { return field.name == std::string("x_m"); };
  m.is_table = m.info.format == GeoFormat::kCsv &&
               std::any_of(layer.fields.begin(), layer.fields.end(), has_place);
  CPLStringList options;
  if (m.info.format == GeoFormat::kGeoPackage) {
    options.SetNameValue("DESCRIPTION", layer.description);
  } else if (m.info.format == GeoFormat::kGeoJson) {
    options.SetNameValue("RFC7946", "YES");
    options.SetNameValue("COORDINATE_PRECISION", "9");  // a tenth of a millimetre
    options.SetNameValue("DESCRIPTION", layer.description);
  } else if (m.info.format == GeoFormat::kShapefile) {
    options.SetNameValue("ENCODING", "UTF-8");
  } else if (m.info.format == GeoFormat::kCsv && !m.is_table) {
    options.SetNameValue("GEOMETRY", "AS_WKT");
  }
  const auto type = m.is_table                              ? wkbNone
                    : layer.geometry == GeoGeometry::kPoint ? wkbPoint
                    : layer.geometry == GeoGeometry::kArea  ? wkbPolygon
                                                            : wkbLineString;
  m.layer = m.dataset->CreateLayer(layer.name, is_drawing || m.is_table ? nullptr : &m.srs,
                                   is_drawing ? wkbUnknown : type, options.List());
  m.require(m.layer != nullptr);
  if (is_drawing) return;  // its fields are fixed by the format
  for (const GeoField& field : layer.fields) {
    OGRFieldDefn definition(field.name, ogr_type(field.type));
    m.require(m.layer->CreateField(&definition) == OGRERR_NONE);
  }
  if (!layer.qml.empty()) m.styled.push_back(layer);
}

void GeoFile::Impl::set_values(const std::vector<GeoValue>& values, OGRFeature& feature) const {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const int field = static_cast<int>(i);
    switch (values[i].kind) {
      case GeoValue::Kind::kNone:
        break;
      case GeoValue::Kind::kInteger:
        feature.SetField(field, static_cast<GIntBig>(values[i].integer));
        break;
      case GeoValue::Kind::kReal:
        feature.SetField(field, values[i].real);
        break;
      case GeoValue::Kind::kText:
        feature.SetField(field, values[i].text.c_str());
        break;
    }
  }
}

/// A drawing has no columns: the class becomes the layer name, the label a text beside it.
void GeoFile::Impl::add_drawing(const std::vector<GeoValue>& values, const OGRGeometry& geometry) {
  std::string layer_name = begun.name, label;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (begun.fields[i].name == std::string("class")) layer_name = values[i].text;
    if (begun.fields[i].name == std::string("label")) label = values[i].text;
  }
  OGRFeature feature(layer->GetLayerDefn());
  feature.SetField("Layer", layer_name.c_str());
  feature.SetGeometry(&geometry);
  require(layer->CreateFeature(&feature) == OGRERR_NONE);
  if (label.empty() || geometry.getGeometryType() != wkbPoint) return;
  std::replace(label.begin(), label.end(), '"', ' ');
  OGRFeature text(layer->GetLayerDefn());
  text.SetField("Layer", (layer_name + " labels").c_str());
  text.SetGeometry(&geometry);
  text.SetStyleString(("LABEL(f:\"Arial\",s:0.3g,t:\"" + label + "\")").c_str());
  require(layer->CreateFeature(&text) == OGRERR_NONE);
}

void GeoFile::add(const std::vector<GeoValue>& values,
                  const std::vector<Eigen::Vector2d>& points_map) {
  Impl& m = *impl_;
  if (m.layer == nullptr) return;
  ++m.written.back().second;
  OGRLineString line;
  for (const Eigen::Vector2d& p : points_map) {
    const OGRPoint point = m.point(p);
    line.addPoint(&point);
  }
  OGRPoint point;
  if (points_map.size() == 1) line.getPoint(0, &point);
  OGRPolygon area;
  if (m.begun.geometry == GeoGeometry::kArea) {
    OGRLinearRing border;
    border.addSubLineString(&line);
    border.closeRings();
    area.addRing(&border);
  }
  const OGRGeometry& geometry = points_map.size() == 1 ? static_cast<const OGRGeometry&>(point)
                                : area.IsEmpty()       ? static_cast<const OGRGeometry&>(line)
                                                       : area;
  if (m.info.format == GeoFormat::kDxf) {
    m.add_drawing(values, geometry);
    return;
  }
  OGRFeature feature(m.layer->GetLayerDefn());
  m.set_values(values, feature);
  if (!m.is_table) feature.SetGeometry(&geometry);
  m.require(m.layer->CreateFeature(&feature) == OGRERR_NONE);
}

/// Writes the table in which QGIS keeps styles inside a GeoPackage; QGIS applies the default one.
void GeoFile::Impl::write_styles() {
  if (styled.empty() || info.format != GeoFormat::kGeoPackage) return;
  OGRLayer* table = dataset->CreateLayer("layer_styles", nullptr, wkbNone, nullptr);
  require(table != nullptr);
  for (const char* name : {"f_table_catalog", "f_table_schema", "f_table_name", "f_geometry_column",
                           "styleName", "styleQML", "styleSLD", "description", "owner", "ui"}) {
    OGRFieldDefn definition(name, OFTString);
    require(table->CreateField(&definition) == OGRERR_NONE);
  }
  OGRFieldDefn is_default("useAsDefault", OFTInteger);
  is_default.SetSubType(OFSTBoolean);
  OGRFieldDefn changed("update_time", OFTDateTime);
  require(table->CreateField(&is_default) == OGRERR_NONE &&
          table->CreateField(&changed) == OGRERR_NONE);
  for (const GeoLayer& of : styled) {
    OGRFeature row(table->GetLayerDefn());
    for (const char* name : {"f_table_catalog", "f_table_schema", "styleSLD", "owner", "ui"}) {
      row.SetField(name, "");
    }
    row.SetField("f_table_name", of.name);
    row.SetField("f_geometry_column", "geom");
    row.SetField("styleName", of.name);
    row.SetField("styleQML", of.qml.c_str());
    row.SetField("description", of.description);
    row.SetField("useAsDefault", 1);
    row.SetField("update_time", 2000, 1, 1, 0, 0, 0.0F, 100);
    require(table->CreateFeature(&row) == OGRERR_NONE);
  }
}

std::string GeoFile::finish() {
  Impl& m = *impl_;
  m.write_styles();
  if (m.dataset->TestCapability(ODsCTransactions)) {
    m.require(m.dataset->CommitTransaction() == OGRERR_NONE);
  }
  m.dataset.reset();
  std::string bytes = m.file.bytes();
  m.require(!bytes.empty());
  return bytes;
}

}  // namespace orchard::io
