// SPDX-License-Identifier: BSD-3-Clause
#include "io/map_geopackage.hpp"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>
#include <unistd.h>

#include <atomic>
#include <memory>

#include "io/file_error.hpp"
#include "io/map_csv.hpp"

namespace orchard::io {
namespace {

/// GDAL writes the time of day into a GeoPackage unless it is told one.
constexpr char kFixedDate[] = "2000-01-01T00:00:00.000Z";

/// Collects what GDAL complains about instead of letting it print.
class ErrorCollector {
 public:
  ErrorCollector() { CPLPushErrorHandlerEx(&ErrorCollector::handle, this); }
  ~ErrorCollector() { CPLPopErrorHandler(); }
  ErrorCollector(const ErrorCollector&) = delete;
  ErrorCollector& operator=(const ErrorCollector&) = delete;

  const std::string& first() const { return first_; }

 private:
  static void CPL_STDCALL handle(CPLErr level, CPLErrorNum, const char* message) {
    auto* self = static_cast<ErrorCollector*>(CPLGetErrorHandlerUserData());
    if (level >= CE_Failure && self->first_.empty()) self->first_ = message;
  }
  std::string first_;
};

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

void require(bool holds, const ErrorCollector& errors) {
  if (holds && errors.first().empty()) return;
  throw FileError("map.gpkg: GDAL cannot write it (" +
                  (errors.first().empty() ? std::string("no reason given") : errors.first()) +
                  "); is GDAL complete, with its GPKG driver?");
}

OGRSpatialReference map_frame() {
  OGRSpatialReference srs;
  srs.SetLocalCS("map");
  srs.SetLinearUnits("metre", 1.0);
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return srs;
}

void add_field(OGRLayer& layer, const char* name, OGRFieldType type) {
  OGRFieldDefn field(name, type);
  layer.CreateField(&field);
}

void write_landmarks(GDALDataset& dataset, OGRSpatialReference& srs, const ErrorCollector& errors,
                     const std::vector<mapping::Landmark>& landmarks) {
  OGRLayer* layer = dataset.CreateLayer("landmarks", &srs, wkbPoint, nullptr);
  require(layer != nullptr, errors);
  add_field(*layer, "id", OFTInteger);
  add_field(*layer, "class", OFTString);
  add_field(*layer, "x_m", OFTReal);
  add_field(*layer, "y_m", OFTReal);
  add_field(*layer, "n", OFTInteger);
  for (const char* name : {"roc_mean", "probability", "se_x_m", "se_y_m", "width_m"}) {
    add_field(*layer, name, OFTReal);
  }
  add_field(*layer, "row", OFTInteger);
  add_field(*layer, "position", OFTInteger);
  for (const mapping::Landmark& landmark : landmarks) {
    OGRFeature feature(layer->GetLayerDefn());
    int field = 0;
    feature.SetField(field++, landmark.id);
    feature.SetField(field++, label_text(landmark.label));
    feature.SetField(field++, landmark.x_m);
    feature.SetField(field++, landmark.y_m);
    feature.SetField(field++, landmark.num_observations);
    feature.SetField(field++, landmark.roc_mean);
    feature.SetField(field++, landmark.probability);
    feature.SetField(field++, landmark.se_x_m);
    feature.SetField(field++, landmark.se_y_m);
    feature.SetField(field++, landmark.width_m);
    if (landmark.row != 0) feature.SetField(field, landmark.row);
    if (landmark.position != 0) feature.SetField(field + 1, landmark.position);
    const OGRPoint point(landmark.x_m, landmark.y_m);
    feature.SetGeometry(&point);
    require(layer->CreateFeature(&feature) == OGRERR_NONE, errors);
  }
}

void write_path(GDALDataset& dataset, OGRSpatialReference& srs, const ErrorCollector& errors,
                const std::vector<pose::PoseEstimate>& trajectory) {
  OGRLayer* layer = dataset.CreateLayer("path", &srs, wkbLineString, nullptr);
  require(layer != nullptr, errors);
  add_field(*layer, "first_utime_us", OFTInteger64);
  add_field(*layer, "last_utime_us", OFTInteger64);
  if (trajectory.size() < 2) return;  // no line
  OGRFeature feature(layer->GetLayerDefn());
  feature.SetField(0, static_cast<GIntBig>(trajectory.front().utime));
  feature.SetField(1, static_cast<GIntBig>(trajectory.back().utime));
  OGRLineString line;
  line.setNumPoints(static_cast<int>(trajectory.size()));
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    line.setPoint(static_cast<int>(i), trajectory[i].x_m, trajectory[i].y_m);
  }
  feature.SetGeometry(&line);
  require(layer->CreateFeature(&feature) == OGRERR_NONE, errors);
}

void write_rows(GDALDataset& dataset, OGRSpatialReference& srs, const ErrorCollector& errors,
                const std::vector<mapping::Row>& rows) {
  OGRLayer* lines = dataset.CreateLayer("rows", &srs, wkbLineString, nullptr);
  require(lines != nullptr, errors);
  for (const char* name : {"row", "trees", "gaps"}) add_field(*lines, name, OFTInteger);
  add_field(*lines, "spacing_m", OFTReal);
  OGRLayer* gaps = dataset.CreateLayer("gaps", &srs, wkbPoint, nullptr);
  require(gaps != nullptr, errors);
  for (const char* name : {"row", "position"}) add_field(*gaps, name, OFTInteger);
  for (const mapping::Row& row : rows) {
    OGRLineString line;
    int num_gaps = 0;
    for (const mapping::RowPlace& place : row.places) {
      line.addPoint(place.p_map.x(), place.p_map.y());
      if (place.landmark_id != 0) continue;
      ++num_gaps;
      OGRFeature gap(gaps->GetLayerDefn());
      gap.SetField(0, row.number);
      gap.SetField(1, place.position);
      const OGRPoint point(place.p_map.x(), place.p_map.y());
      gap.SetGeometry(&point);
      require(gaps->CreateFeature(&gap) == OGRERR_NONE, errors);
    }
    OGRFeature feature(lines->GetLayerDefn());
    feature.SetField(0, row.number);
    feature.SetField(1, static_cast<int>(row.places.size()) - num_gaps);
    feature.SetField(2, num_gaps);
    feature.SetField(3, row.spacing_m);
    feature.SetGeometry(&line);
    require(lines->CreateFeature(&feature) == OGRERR_NONE, errors);
  }
}

}  // namespace

std::string map_geopackage(const std::vector<mapping::Landmark>& landmarks,
                           const std::vector<pose::PoseEstimate>& trajectory,
                           const std::vector<mapping::Row>& rows) {
  GDALAllRegister();
  const CPLConfigOptionSetter fixed_date("OGR_CURRENT_DATE", kFixedDate, false);
  const ErrorCollector errors;
  const MemoryFile file;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
  require(driver != nullptr, errors);
  std::unique_ptr<GDALDataset> dataset(
      driver->Create(file.path().c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  require(dataset != nullptr, errors);
  OGRSpatialReference srs = map_frame();
  require(dataset->StartTransaction() == OGRERR_NONE, errors);
  write_landmarks(*dataset, srs, errors, landmarks);
  write_path(*dataset, srs, errors, trajectory);
  write_rows(*dataset, srs, errors, rows);
  require(dataset->CommitTransaction() == OGRERR_NONE, errors);
  dataset.reset();
  std::string bytes = file.bytes();
  require(!bytes.empty(), errors);
  return bytes;
}

}  // namespace orchard::io
