// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/edited_map_file.hpp"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>

#include "detection/detection.hpp"
#include "io/file_error.hpp"
#include "io/gis/gdal_errors.hpp"
#include "io/gis/map_layers.hpp"
#include "io/sane_limits.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kLandmarksMax = 2000000;
constexpr double kNumberMax = 2147483646.0;

class EditedMapReader {
 public:
  EditedMapReader(const std::string& path,
                  const std::optional<geometry::Georeference>& georeference)
      : path_(path), georeference_(georeference) {
    GDALAllRegister();
    constexpr std::array<const char*, 2> kGeoPackage{"GPKG", nullptr};
    dataset_.reset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY,
                                     kGeoPackage.data(), nullptr, nullptr));
    if (!dataset_) {
      throw FileError(path + " is not a GeoPackage" +
                      (errors_.first().empty() ? "" : " (" + errors_.first() + ")"));
    }
  }

  EditedMapFile read() {
    if (const char* number = dataset_->GetMetadataItem(kCorrectionsMetadata)) {
      const auto num_corrections = whole_number(number);
      if (!num_corrections || *num_corrections < 0) {
        throw FileError(path_ + ": its number of corrections is invalid; export the map again");
      }
      result_.num_corrections = *num_corrections;
    }
    OGRLayer* landmarks = dataset_->GetLayerByName("landmarks");
    if (landmarks == nullptr) {
      throw FileError(path_ + " has no layer `landmarks`; give the edited GeoPackage of a map");
    }
    read_landmarks(*landmarks);
    if (OGRLayer* rows = dataset_->GetLayerByName("rows")) read_rows(*rows);
    if (!errors_.first().empty()) {
      throw FileError(path_ + " could not be read completely (" + errors_.first() + ")");
    }
    return std::move(result_);
  }

 private:
  void read_landmarks(OGRLayer& layer) {
    const OGRFeatureDefn& definition = *layer.GetLayerDefn();
    for (const char* name : {"id", "class"}) {
      if (definition.GetFieldIndex(name) < 0) {
        throw FileError(path_ + ": layer landmarks has no column " + name +
                        "; give the edited GeoPackage of a map");
      }
    }
    set_crs(layer);
    layer.ResetReading();
    while (const OGRFeatureUniquePtr feature{layer.GetNextFeature()}) {
      at_ = path_ + ": feature " + std::to_string(feature->GetFID()) + " of landmarks";
      if (result_.map.landmarks.size() >= kLandmarksMax) {
        throw FileError(path_ + " has over two million landmarks");
      }
      mapping::EditedLandmark l;
      l.id = number(*feature, "id");
      l.p_map = place(*feature);
      l.label = label(*feature, l.id == 0);
      l.width_m = real(*feature, "width_m");
      if (l.width_m > kMaxWidth_m) throw FileError(at_ + ": width_m is out of range");
      l.row = number(*feature, "row");
      l.position = number(*feature, "position");
      l.note = one_line(text(*feature, "note"), l.id);
      result_.map.landmarks.push_back(std::move(l));
    }
  }

  void read_rows(OGRLayer& layer) {
    layer.ResetReading();
    while (const OGRFeatureUniquePtr feature{layer.GetNextFeature()}) {
      at_ = path_ + ": feature " + std::to_string(feature->GetFID()) + " of rows";
      const std::int32_t row = number(*feature, "row");
      if (row > 0) result_.map.row_names[row] = text(*feature, "label");
    }
  }

  void set_crs(OGRLayer& layer) {
    const OGRSpatialReference* own = layer.GetSpatialRef();
    const bool is_on_earth = own != nullptr && (own->IsGeographic() || own->IsProjected());
    if (is_on_earth != georeference_.has_value()) {
      throw FileError(path_ +
                      (is_on_earth
                           ? " has a position on the earth, but the map is not georeferenced"
                           : " has no position on the earth, but the map has") +
                      "; give a file that was exported from this map");
    }
    if (!is_on_earth) return;
    OGRSpatialReference wgs84;
    wgs84.importFromEPSG(4326);
    wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRSpatialReference> srs(own->Clone());
    srs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    to_wgs84_.reset(OGRCreateCoordinateTransformation(srs.get(), &wgs84));
    if (!to_wgs84_) throw FileError(path_ + ": its coordinate system is unknown");
  }

  Vector2d place(const OGRFeature& feature) const {
    const OGRGeometry* geometry = feature.GetGeometryRef();
    if (geometry == nullptr || geometry->IsEmpty() ||
        wkbFlatten(geometry->getGeometryType()) != wkbPoint) {
      throw FileError(at_ + " is not a point; correct or delete it");
    }
    Vector2d p(geometry->toPoint()->getX(), geometry->toPoint()->getY());
    if (to_wgs84_) {
      if (!to_wgs84_->Transform(1, &p.x(), &p.y())) throw FileError(at_ + " is not on the earth");
      p = geometry::map_of(*georeference_, {p.y(), p.x()});
    }
    if (!(p.cwiseAbs().maxCoeff() <= kMaxCoordinate_m)) {
      throw FileError(at_ + " is farther away than a map can reach");
    }
    return p;
  }

  /// A newly drawn feature without class is a tree.
  detection::Label label(const OGRFeature& feature, bool is_new) const {
    const std::string word = text(feature, "class");
    if (word.empty() && is_new) return detection::Label::kTree;
    for (const auto label :
         {detection::Label::kTree, detection::Label::kObject, detection::Label::kUnseen}) {
      if (word == label_text(label)) return label;
    }
    throw FileError(at_ + ": class \"" + printable_text(word.substr(0, 40)) +
                    "\" must be tree, object or unseen");
  }

  double real(const OGRFeature& feature, const char* name) const {
    const int field = feature.GetDefnRef()->GetFieldIndex(name);
    if (field < 0 || !feature.IsFieldSetAndNotNull(field)) return 0.0;
    const double value = feature.GetFieldAsDouble(field);
    if (!(value >= 0.0 && value <= kNumberMax)) {
      throw FileError(at_ + ": " + name + " is out of range");
    }
    return value;
  }
  std::int32_t number(const OGRFeature& feature, const char* name) const {
    const double value = real(feature, name);
    if (value != std::floor(value)) throw FileError(at_ + ": " + name + " must be a whole number");
    return static_cast<std::int32_t>(value);
  }
  static std::string text(const OGRFeature& feature, const char* name) {
    const int field = feature.GetDefnRef()->GetFieldIndex(name);
    if (field < 0 || !feature.IsFieldSetAndNotNull(field)) return {};
    return feature.GetFieldAsString(field);
  }

  /// Joins a note of several lines, because a correction is a single line.
  std::string one_line(const std::string& note, std::int32_t id) {
    std::string line;
    bool is_broken = false;
    for (const char c : note) {
      const bool is_break = c == '\n' || c == '\r';
      is_broken |= is_break;
      if (!is_break) {
        line += c;
      } else if (!line.empty() && line.back() != ' ') {
        line += ' ';
      }
    }
    while (is_broken && !line.empty() && line.back() == ' ') line.pop_back();
    if (is_broken) {
      result_.left_out.push_back("line breaks in the note of " +
                                 (id == 0 ? "a new landmark" : "landmark " + std::to_string(id)));
    }
    return line;
  }

  const std::string& path_;
  const std::optional<geometry::Georeference>& georeference_;
  GdalErrors errors_;
  GDALDatasetUniquePtr dataset_;
  std::unique_ptr<OGRCoordinateTransformation> to_wgs84_;
  std::string at_;
  EditedMapFile result_;
};

}  // namespace

EditedMapFile read_edited_map(const std::string& path,
                              const std::optional<geometry::Georeference>& georeference) {
  return EditedMapReader(path, georeference).read();
}

}  // namespace orchard::io
