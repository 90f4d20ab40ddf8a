// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/plan_file.hpp"

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string_view>
#include <utility>

#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config_yaml.hpp"
#include "io/file_error.hpp"
#include "io/gis/gdal_errors.hpp"
#include "io/gis/survey_file.hpp"
#include "mapping/plan/orchard_plan.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Eigen::Vector2d;

/// A feature of a plan file: a tree, or the line of a row.
struct PlanFeature {
  std::string row, tree;  ///< empty: no name
  /// Longitude and latitude [degrees], or coordinates in the file's metric system; one point for a
  /// tree, several for a line.
  std::vector<Eigen::Vector2d> points;
  double sd_m = 0.0;  ///< of a tree's place; 0: not stated
};

struct PlanFeatures {
  std::string format;
  std::string crs;             ///< "local" for none
  bool is_geographic = false;  ///< points are longitude and latitude (WGS 84)
  std::vector<PlanFeature> trees, lines;
  std::vector<std::string> notes;
};

constexpr double kLocalMax_m = 100000.0;

/// Middle of the bounding box of all points. For a block across the date line it is far away, which
/// to_metres() reports.
Vector2d middle_of(const PlanFeatures& features) {
  Vector2d low(1e300, 1e300), high(-1e300, -1e300);
  for (const auto* list : {&features.trees, &features.lines}) {
    for (const PlanFeature& f : *list) {
      for (const Vector2d& p : f.points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
    }
  }
  return 0.5 * (low + high);
}

/// Converts degrees to metres about the middle; returns this georeference. Throws FileError for
/// points too far from it.
std::optional<geometry::Georeference> to_metres(PlanFeatures& features, const std::string& name) {
  const Vector2d middle = middle_of(features);
  std::optional<geometry::Georeference> georeference;
  if (features.is_geographic) {
    georeference.emplace();
    georeference->longitude_deg = middle.x();
    georeference->latitude_deg = middle.y();
  }
  for (auto* list : {&features.trees, &features.lines}) {
    for (PlanFeature& f : *list) {
      for (Vector2d& p : f.points) {
        if (georeference) p = geometry::map_of(*georeference, {p.y(), p.x()});
        const Vector2d from_middle = georeference ? p : Vector2d(p - middle);
        if (from_middle.norm() > kFarthestInBlock_m) {
          throw FileError(name + ": row " + f.row + " is " +
                          fixed_text(1e-3 * from_middle.norm(), 0) +
                          " km from the middle of the plan; check its coordinate system (--crs)");
        }
        if (!georeference && p.cwiseAbs().maxCoeff() > kLocalMax_m) {
          throw FileError(name + ": x " + fixed_text(p.x(), 1) + ", y " + fixed_text(p.y(), 1) +
                          " are coordinates of a national or UTM system that the file does not "
                          "name; give it, for example --crs EPSG:25830");
        }
      }
    }
  }
  return georeference;
}

mapping::BuiltPlan built(PlanFeatures features, const PlanFileOptions& options,
                         const std::string& name) {
  if (!features.trees.empty()) {
    if (!features.lines.empty()) {
      features.notes.push_back("the plan has trees, so its " +
                               std::to_string(features.lines.size()) + " lines were ignored");
    }
    std::vector<mapping::LoosePlannedTree> trees;
    for (PlanFeature& f : features.trees) {
      trees.push_back({std::move(f.row), std::move(f.tree), f.points.front()});
    }
    mapping::BuiltPlan plan = mapping::plan_of_trees(trees);
    plan.notes.insert(plan.notes.begin(), features.notes.begin(), features.notes.end());
    return plan;
  }
  if (features.lines.empty()) {
    throw FileError(name + " has neither points (trees) nor lines (rows)");
  }
  if (options.spacing_m <= 0.0) {
    throw FileError(
        name +
        " has rows as lines; give the distance between the trees, for example --spacing 3.0");
  }
  std::vector<mapping::PlannedLine> lines;
  for (PlanFeature& f : features.lines) lines.push_back({std::move(f.row), std::move(f.points)});
  mapping::BuiltPlan plan = mapping::plan_of_lines(lines, options.spacing_m);
  plan.notes.insert(plan.notes.begin(), features.notes.begin(), features.notes.end());
  return plan;
}

bool is_yaml(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".yaml" || extension == ".yml";
}

constexpr std::size_t kNumFeaturesMax = 2000000;
constexpr std::size_t kNumPointsMax = 100000;  ///< per line
constexpr std::size_t kLongestName = 64;
constexpr double kWidestCrown_m = 15.0;  ///< a closed line up to this width is a tree
constexpr double kSdMax_m = 10.0;        ///< worse places cannot tell trees apart

// Common column names, most likely first.
constexpr std::array kRowFields{"row",  "row_name", "row_number", "rowname", "row_id", "row_no",
                                "line", "fila",     "hilera",     "linea",   "reihe",  "rang"};
constexpr std::array kTreeFields{"tree",   "tree_name", "tree_number", "position", "tree_no",
                                 "number", "arbol",     "planta",      "baum",     "arbre"};
constexpr std::array kLineNameFields{"name", "nombre", "id"};
constexpr std::array kLongitudeFields{"longitude_deg", "longitude", "lon", "lng", "long"};
constexpr std::array kLatitudeFields{"latitude_deg", "latitude", "lat"};
constexpr std::array kSdFields{"sd_m", "accuracy_m", "horizontal_accuracy_m", "h_acc_m", "hrms_m"};
constexpr std::array kXFields{"x_m", "x", "easting", "east", "utm_e"};
constexpr std::array kYFields{"y_m", "y", "northing", "north", "utm_n"};

constexpr std::array<const char*, 9> kDrivers{
    "GPKG", "ESRI Shapefile", "GeoJSON", "LIBKML", "KML", "DXF", "CSV", "FlatGeobuf", nullptr};

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

template <std::size_t N>
int field_of(const OGRFeatureDefn& definition, const std::array<const char*, N>& names) {
  for (const char* name : names) {
    for (int i = 0; i < definition.GetFieldCount(); ++i) {
      if (lower(definition.GetFieldDefn(i)->GetNameRef()) == name) return i;
    }
  }
  return -1;
}

std::string fields_text(const OGRFeatureDefn& definition) {
  std::string text;
  for (int i = 0; i < definition.GetFieldCount(); ++i) {
    text += std::string(i == 0 ? "" : ", ") + definition.GetFieldDefn(i)->GetNameRef();
  }
  return text.empty() ? "none" : text;
}

std::unique_ptr<OGRSpatialReference> named_crs(const std::string& name) {
  auto srs = std::make_unique<OGRSpatialReference>();
  if (srs->SetFromUserInput(name.c_str()) != OGRERR_NONE) {
    throw FileError("--crs " + name +
                    " is not a coordinate system; give a code such as EPSG:25830");
  }
  return srs;
}

std::string crs_text(const OGRSpatialReference& srs) {
  const char* authority = srs.GetAuthorityName(nullptr);
  const char* code = srs.GetAuthorityCode(nullptr);
  if (authority != nullptr && code != nullptr) return std::string(authority) + ":" + code;
  return srs.GetName() != nullptr ? srs.GetName() : "unnamed";
}

class PlanFeatureReader {
 public:
  PlanFeatureReader(const std::string& path, const PlanFileOptions& options)
      : path_(path), options_(options) {
    GDALAllRegister();
    dataset_.reset(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY,
                                     kDrivers.data(), nullptr, nullptr));
    if (!dataset_) {
      throw FileError(path +
                      " is not a GeoPackage, Shapefile, GeoJSON, KML, DXF, FlatGeobuf or CSV file" +
                      (errors_.first().empty() ? "" : " (" + errors_.first() + ")"));
    }
    driver_ = dataset_->GetDriver()->GetDescription();
    result_.format = driver_;
    result_.crs = "local";
  }

  PlanFeatures read() {
    const std::vector<OGRLayer*> layers = chosen_layers();
    for (OGRLayer* layer : layers) read_layer(*layer, layers.size() > 1);
    if (!errors_.first().empty()) {
      throw FileError(path_ + " could not be read completely (" + errors_.first() + ")");
    }
    if (num_left_out_ > 0) {
      result_.notes.push_back(std::to_string(num_left_out_) +
                              " features that are neither points nor lines were ignored");
    }
    return std::move(result_);
  }

 private:
  /// The layers to read. In KML and DXF all layers belong to one plan; otherwise one layer.
  std::vector<OGRLayer*> chosen_layers() const {
    std::vector<OGRLayer*> layers;
    std::string names;
    for (OGRLayer* layer : dataset_->GetLayers()) {
      names += (names.empty() ? "" : ", ") + std::string(layer->GetName());
      if (options_.layer.empty() || options_.layer == layer->GetName()) layers.push_back(layer);
    }
    if (layers.empty()) {
      throw FileError(path_ + (options_.layer.empty()
                                   ? " has no layer"
                                   : " has no layer " + options_.layer + ", only: " + names));
    }
    const bool are_folders = driver_ == "LIBKML" || driver_ == "KML" || driver_ == "DXF";
    if (layers.size() > 1 && !are_folders) {
      throw FileError(path_ +
                      " has several layers; choose that of the plan with --layer: " + names);
    }
    return layers;
  }

  void read_layer(OGRLayer& layer, bool is_folder) {
    const OGRFeatureDefn& definition = *layer.GetLayerDefn();
    const auto chosen = [&](const std::string& name, const auto& usual) {
      if (name.empty()) return field_of(definition, usual);
      const int field = definition.GetFieldIndex(name.c_str());
      if (field >= 0) return field;
      throw FileError(path_ + " has no column " + name + ", only: " + fields_text(definition));
    };
    int row_field = chosen(options_.row_field, kRowFields);
    const int tree_field = chosen(options_.tree_field, kTreeFields);
    const int sd_field = field_of(definition, kSdFields);
    const int name_field = field_of(definition, kLineNameFields);
    const int longitude = field_of(definition, kLongitudeFields);
    const int latitude = field_of(definition, kLatitudeFields);
    const int x = field_of(definition, kXFields), y = field_of(definition, kYFields);
    const bool is_table = driver_ == "CSV" && definition.GetGeomFieldCount() == 0;
    const bool has_degrees = longitude >= 0 && latitude >= 0;
    if (is_table && !has_degrees && (x < 0 || y < 0)) {
      throw FileError(
          path_ + " has no columns with positions (latitude and longitude, or x and y), only: " +
          fields_text(definition));
    }
    set_crs(layer, is_table && has_degrees);
    // if a drawing has several layers, each is a row
    const int drawing_layer = driver_ == "DXF" ? definition.GetFieldIndex("Layer") : -1;
    if (row_field < 0 && drawing_layer >= 0 && has_several(layer, drawing_layer)) {
      row_field = drawing_layer;
    }
    layer.ResetReading();
    for (std::int64_t number = 1;; ++number) {
      const OGRFeatureUniquePtr feature(layer.GetNextFeature());
      if (!feature) break;
      at_ = path_ + ": feature " + std::to_string(number) +
            (is_folder ? " of layer " + std::string(layer.GetName()) : std::string());
      if (result_.trees.size() + result_.lines.size() >= kNumFeaturesMax) {
        throw FileError(path_ + " has over two million features; give the plan of one block");
      }
      PlanFeature f;
      f.row = name_of(*feature, row_field);
      if (f.row.empty() && row_field < 0 && is_folder) f.row = layer.GetName();
      f.tree = name_of(*feature, tree_field);
      if (sd_field >= 0 && !name_of(*feature, sd_field).empty()) {
        f.sd_m = number_of(*feature, sd_field);
        if (!(f.sd_m > 0.0 && f.sd_m <= kSdMax_m)) {
          throw FileError(at_ + ": its accuracy must be above 0 and at most " +
                          fixed_text(kSdMax_m, 0) + " m");
        }
      }
      if (is_table) {
        const Vector2d p(number_of(*feature, has_degrees ? longitude : x),
                         number_of(*feature, has_degrees ? latitude : y));
        f.points = {checked(p)};
        result_.trees.push_back(std::move(f));
        continue;
      }
      const OGRGeometry* geometry = feature->GetGeometryRef();
      if (geometry == nullptr || geometry->IsEmpty()) {
        throw FileError(at_ + " has no position; correct or delete it");
      }
      if (!take(*geometry, f)) {
        ++num_left_out_;
      } else if (f.points.size() == 1) {
        result_.trees.push_back(std::move(f));
      } else {
        if (f.row.empty()) f.row = name_of(*feature, name_field);
        result_.lines.push_back(std::move(f));
      }
    }
  }

  static bool has_several(OGRLayer& layer, int field) {
    layer.ResetReading();
    std::string first;
    for (std::size_t k = 0; k < kNumFeaturesMax; ++k) {
      const OGRFeatureUniquePtr feature(layer.GetNextFeature());
      if (!feature) return false;
      const std::string value = feature->GetFieldAsString(field);
      if (k == 0) first = value;
      if (value != first) return true;
    }
    return false;
  }

  void set_crs(OGRLayer& layer, bool is_wgs84) {
    OGRSpatialReference wgs84;
    wgs84.importFromEPSG(4326);
    wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    to_wgs84_.reset();
    std::unique_ptr<OGRSpatialReference> srs;
    if (const OGRSpatialReference* own = layer.GetSpatialRef()) srs.reset(own->Clone());
    if (srs && (srs->IsLocal() || (!srs->IsGeographic() && !srs->IsProjected()))) srs.reset();
    if (is_wgs84) srs.reset(wgs84.Clone());
    if (!options_.crs.empty()) {
      auto given = named_crs(options_.crs);
      given->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
      if (srs && !srs->IsSame(given.get())) {
        result_.notes.push_back("the file states " + crs_text(*srs) + "; it is read as " +
                                options_.crs + ", as --crs says");
      }
      srs = std::move(given);
    }
    if (!srs) return;
    srs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    to_wgs84_.reset(OGRCreateCoordinateTransformation(srs.get(), &wgs84));
    if (!to_wgs84_) {
      throw FileError(path_ + ": " + crs_text(*srs) +
                      " cannot be converted to latitude and longitude");
    }
    result_.crs = crs_text(*srs);
    result_.is_geographic = true;
  }

  std::string name_of(const OGRFeature& feature, int field) const {
    if (field < 0 || !feature.IsFieldSetAndNotNull(field)) return {};
    std::string name = feature.GetFieldAsString(field);
    while (!name.empty() && name.back() == ' ') name.pop_back();
    name.erase(0, name.find_first_not_of(' '));
    const bool is_text = std::none_of(name.begin(), name.end(), [](char c) {
      return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
    });
    if (name.size() > kLongestName || !is_text) {
      throw FileError(at_ + ": the name must have at most " + std::to_string(kLongestName) +
                      " characters, without control characters");
    }
    return name;
  }

  double number_of(const OGRFeature& feature, int field) const {
    const std::string_view text = feature.GetFieldAsString(field);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      throw FileError(at_ + ": " + feature.GetDefnRef()->GetFieldDefn(field)->GetNameRef() +
                      " = \"" + std::string(text.substr(0, kLongestName)) + "\" is not a number");
    }
    return value;
  }

  /// Transforms a point to WGS 84 if the file's coordinate system is known.
  Vector2d checked(Vector2d p) const {
    if (to_wgs84_ && !to_wgs84_->Transform(1, &p.x(), &p.y())) {
      throw FileError(at_ + " is outside the area of " + result_.crs);
    }
    const bool is_place = std::isfinite(p.x()) && std::isfinite(p.y()) &&
                          (!to_wgs84_ || (std::abs(p.x()) <= 180.0 && std::abs(p.y()) <= 89.0));
    if (!is_place)
      throw FileError(at_ + " is not on the earth; check its coordinate system (--crs)");
    return p;
  }

  /// Adds the points of a feature; false for geometries other than points and lines.
  bool take(const OGRGeometry& geometry, PlanFeature& f) const {
    const auto flat = wkbFlatten(geometry.getGeometryType());
    if (flat == wkbPoint) {
      const OGRPoint* p = geometry.toPoint();
      f.points = {checked({p->getX(), p->getY()})};
      return true;
    }
    if (flat == wkbMultiPoint || flat == wkbMultiLineString || flat == wkbGeometryCollection) {
      const OGRGeometryCollection* parts = geometry.toGeometryCollection();
      return parts->getNumGeometries() == 1 && take(*parts->getGeometryRef(0), f);
    }
    if (flat != wkbLineString) return false;
    const OGRLineString* line = geometry.toLineString();
    if (line->getNumPoints() < 2) return false;
    if (static_cast<std::size_t>(line->getNumPoints()) > kNumPointsMax) {
      throw FileError(at_ + " is a line of over " + std::to_string(kNumPointsMax) + " points");
    }
    if (driver_ == "DXF" && line->get_IsClosed()) {
      OGREnvelope box;
      line->getEnvelope(&box);
      if (box.MaxX - box.MinX > kWidestCrown_m || box.MaxY - box.MinY > kWidestCrown_m) {
        return false;
      }
      f.points = {checked({0.5 * (box.MinX + box.MaxX), 0.5 * (box.MinY + box.MaxY)})};
      return true;
    }
    for (int i = 0; i < line->getNumPoints(); ++i) {
      f.points.push_back(checked({line->getX(i), line->getY(i)}));
    }
    return true;
  }

  const std::string& path_;
  const PlanFileOptions& options_;
  GdalErrors errors_;
  // insert blocks of a drawing (a tree's symbol) as points
  CPLConfigOptionSetter symbols_as_points_{"DXF_INLINE_BLOCKS", "FALSE", false};
  GDALDatasetUniquePtr dataset_;
  std::unique_ptr<OGRCoordinateTransformation> to_wgs84_;
  std::string driver_;
  std::string at_;
  PlanFeatures result_;
  std::size_t num_left_out_ = 0;
};

enum class RowsTo { kRight, kLeft };

/// A regular grid, for example 12 rows, 4.5 m apart, 40 trees every 3 m, from a corner.
struct PlanGrid {
  int rows = 0;
  int trees = 0;
  double row_spacing_m = 0.0;
  double tree_spacing_m = 0.0;
  std::vector<double> corner_deg;
  double bearing_deg = 0.0;
  RowsTo rows_to = RowsTo::kRight;
  int first_row = 1;
  int first_tree = 1;
};

void describe(ConfigVisitor& v, PlanGrid& g) {
  v.integer("rows", g.rows, 1, 100000, "", "number of rows");
  v.integer("trees", g.trees, 1, 100000, "", "number of trees per row");
  v.number("row_spacing_m", g.row_spacing_m, 0.2, 100.0, "m", "distance between rows");
  v.number("tree_spacing_m", g.tree_spacing_m, 0.2, 100.0, "m",
           "distance between the trees of a row");
  v.numbers("corner_deg", g.corner_deg, -180.0, 180.0, "degrees",
            "latitude and longitude of the first tree of the first row; without it the plan is not "
            "georeferenced");
  v.number("bearing_deg", g.bearing_deg, -360.0, 360.0, "degrees",
           "bearing of the rows from the first to the last tree, clockwise from north");
  v.choice("rows_to", g.rows_to, {"right", "left"},
           "side of the second row, looking along the first");
  v.integer("first_row", g.first_row, 1, 1000000, "", "number of the first row");
  v.integer("first_tree", g.first_tree, 1, 1000000, "", "number of the first tree of each row");
  v.check(g.rows > 0, "rows", "is missing: the number of rows");
  v.check(g.trees > 0, "trees", "is missing: the number of trees per row");
  v.check(g.row_spacing_m > 0.0, "row_spacing_m", "is missing: the distance between rows");
  v.check(g.tree_spacing_m > 0.0, "tree_spacing_m",
          "is missing: the distance between the trees of a row");
  v.check(g.corner_deg.empty() || (g.corner_deg.size() == 2 && std::abs(g.corner_deg[0]) <= 90.0),
          "corner_deg", "must be [latitude, longitude]");
  v.check(static_cast<double>(g.rows) * g.trees <= 2e6, "trees",
          "gives more than two million trees");
}

/// Reads a regular grid described in YAML. Throws ConfigError, FileError.
PlanFeatures read_plan_grid(const std::string& path) {
  constexpr std::size_t kBytesMax = std::size_t{1} << 20;
  PlanGrid grid;
  PlanFeatures features;
  features.notes = read_yaml(read_file(path, kBytesMax, "give a plan"), path,
                             [&](ConfigVisitor& v) { describe(v, grid); });
  features.format = "YAML";
  features.is_geographic = !grid.corner_deg.empty();
  features.crs = features.is_geographic ? "EPSG:4326" : "local";
  const double bearing_rad = grid.bearing_deg * geometry::kPi / 180.0;
  const Vector2d along(std::sin(bearing_rad), std::cos(bearing_rad));
  const Vector2d right(along.y(), -along.x());
  const Vector2d step = (grid.rows_to == RowsTo::kRight ? 1.0 : -1.0) * right;
  geometry::Georeference corner;
  if (features.is_geographic) {
    corner.latitude_deg = grid.corner_deg[0];
    corner.longitude_deg = grid.corner_deg[1];
  }
  for (int r = 0; r < grid.rows; ++r) {
    for (int k = 0; k < grid.trees; ++k) {
      Vector2d p = r * grid.row_spacing_m * step + k * grid.tree_spacing_m * along;
      if (features.is_geographic) {
        const geometry::Geodetic place = geometry::geodetic_of(corner, p);
        p = {place.longitude_deg, place.latitude_deg};
      }
      features.trees.push_back(
          {std::to_string(grid.first_row + r), std::to_string(grid.first_tree + k), {p}});
    }
  }
  return features;
}

/// Reads the trees and rows of a file, through GDAL if it is not YAML. Throws FileError.
PlanFeatures read_features(const std::string& path, const PlanFileOptions& options) {
  if (!std::filesystem::is_regular_file(path)) {
    throw FileError(path + (std::filesystem::exists(path) ? " is not a file" : " does not exist") +
                    "; give a plan (GeoPackage, Shapefile, GeoJSON, KML, DXF, CSV, or YAML)");
  }
  return is_yaml(path) ? read_plan_grid(path) : PlanFeatureReader(path, options).read();
}

}  // namespace

StoredSurvey read_survey(const std::string& path, const PlanFileOptions& options) {
  StoredSurvey survey;
  survey.name = path;
  PlanFeatures features = read_features(path, options);
  if (features.trees.empty() || !features.lines.empty()) {
    throw FileError(path +
                    (features.trees.empty() ? " has no points" : " has lines beside points") +
                    "; a survey has one point for each trunk or post");
  }
  survey.georeference = to_metres(features, path);
  survey.notes = std::move(features.notes);
  for (PlanFeature& f : features.trees) {
    survey.points.push_back({std::move(f.row), std::move(f.tree), f.points.front(), f.sd_m});
  }
  require_apart(survey);
  return survey;
}

StoredPlan read_plan(const std::string& path, const PlanFileOptions& options) {
  PlanFeatures features = read_features(path, options);
  StoredPlan stored;
  stored.name = path;
  stored.format = features.format;
  stored.crs = features.crs;
  stored.georeference = to_metres(features, path);
  mapping::BuiltPlan plan = built(std::move(features), options, path);
  if (!plan.problems.empty()) {
    std::string text;
    for (const std::string& problem : plan.problems) text += (text.empty() ? "" : "; ") + problem;
    throw FileError(path + ": " + text +
                    "; correct the plan, or name its columns with --row-field and --tree-field");
  }
  stored.plan = std::move(plan.plan);
  stored.notes = std::move(plan.notes);
  return stored;
}

mapping::OrchardPlan plan_in_map(const StoredPlan& plan, const geometry::Georeference& of_map) {
  mapping::OrchardPlan result = plan.plan;
  if (!plan.georeference) return result;
  for (mapping::PlannedRow& row : result.rows) {
    for (mapping::PlannedTree& tree : row.trees) {
      tree.p_plan =
          geometry::map_of(of_map, geometry::geodetic_of(*plan.georeference, tree.p_plan));
    }
  }
  return result;
}

}  // namespace orchard::io
