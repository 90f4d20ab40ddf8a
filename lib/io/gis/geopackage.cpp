// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/geopackage.hpp"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>
#include <unistd.h>

#include <atomic>

#include "io/file_error.hpp"
#include "io/gis/gdal_errors.hpp"

namespace orchard::io {
namespace {

/// GDAL writes the time of day into a GeoPackage unless it is told one.
constexpr char kFixedDate[] = "2000-01-01T00:00:00.000Z";

/// A file in memory; gone with this object.
class MemoryFile {
 public:
  MemoryFile() {
    static std::atomic<unsigned> counter{0};
    path_ = "/vsimem/orchard-" + std::to_string(::getpid()) + "-" + std::to_string(counter++) +
            "/map.gpkg";
  }
  ~MemoryFile() { VSIUnlink(path_.c_str()); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  const std::string& path() const { return path_; }
  std::string bytes() const {
    vsi_l_offset size = 0;
    const GByte* data = VSIGetMemFileBuffer(path_.c_str(), &size, FALSE);
    return data == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(data), size);
  }

 private:
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

}  // namespace

struct GeoPackage::Impl {
  explicit Impl(const std::optional<geometry::Georeference>& g) : georeference(g) {}

  void require(bool holds) const {
    if (holds && errors.first().empty()) return;
    throw FileError("map.gpkg: GDAL cannot write it (" +
                    (errors.first().empty() ? std::string("no reason given") : errors.first()) +
                    "); is GDAL complete, with its GPKG driver?");
  }
  OGRPoint point(const Eigen::Vector2d& p_map) const {
    if (!georeference) return OGRPoint(p_map.x(), p_map.y());
    const Eigen::Vector2d p = geometry::utm_of(*georeference, p_map);
    return OGRPoint(p.x(), p.y());
  }

  std::optional<geometry::Georeference> georeference;
  CPLConfigOptionSetter fixed_date{"OGR_CURRENT_DATE", kFixedDate, false};
  GdalErrors errors;
  MemoryFile file;
  OGRSpatialReference srs;
  std::unique_ptr<GDALDataset> dataset;
  OGRLayer* layer = nullptr;
};

GeoPackage::GeoPackage(const std::optional<geometry::Georeference>& georeference) {
  GDALAllRegister();
  impl_ = std::make_unique<Impl>(georeference);
  Impl& m = *impl_;
  if (georeference) {
    m.require(m.srs.importFromEPSG(geometry::utm_epsg(*georeference)) == OGRERR_NONE);
  } else {
    m.srs.SetLocalCS("map");
    m.srs.SetLinearUnits("metre", 1.0);
  }
  m.srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  m.require(driver != nullptr);
  m.dataset.reset(driver->Create(m.file.path().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  m.require(m.dataset != nullptr);
  m.require(m.dataset->StartTransaction() == OGRERR_NONE);
}

GeoPackage::~GeoPackage() = default;

void GeoPackage::begin_layer(const char* name, GeoGeometry geometry,
                             const std::vector<GeoField>& fields) {
  Impl& m = *impl_;
  m.layer = m.dataset->CreateLayer(
      name, &m.srs, geometry == GeoGeometry::kPoint ? wkbPoint : wkbLineString, nullptr);
  m.require(m.layer != nullptr);
  for (const GeoField& field : fields) {
    OGRFieldDefn definition(field.name, ogr_type(field.type));
    m.require(m.layer->CreateField(&definition) == OGRERR_NONE);
  }
}

void GeoPackage::add(const std::vector<GeoValue>& values,
                     const std::vector<Eigen::Vector2d>& points_map) {
  Impl& m = *impl_;
  OGRFeature feature(m.layer->GetLayerDefn());
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
  if (points_map.size() == 1) {
    const OGRPoint point = m.point(points_map.front());
    feature.SetGeometry(&point);
  } else {
    OGRLineString line;
    for (const Eigen::Vector2d& p : points_map) {
      const OGRPoint point = m.point(p);
      line.addPoint(&point);
    }
    feature.SetGeometry(&line);
  }
  m.require(m.layer->CreateFeature(&feature) == OGRERR_NONE);
}

std::string GeoPackage::finish() {
  Impl& m = *impl_;
  m.require(m.dataset->CommitTransaction() == OGRERR_NONE);
  m.dataset.reset();
  std::string bytes = m.file.bytes();
  m.require(!bytes.empty());
  return bytes;
}

}  // namespace orchard::io
