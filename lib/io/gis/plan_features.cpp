// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/plan_features.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "io/file_error.hpp"
#include "io/gis/vector_file.hpp"
#include "text/number_text.hpp"
#include "text/parse_number.hpp"

namespace orchard::io {
namespace {

using Eigen::Vector2d;

constexpr const char* kWgs84 = "EPSG:4326";
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

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

template <std::size_t N>
int field_of(const VectorLayer& layer, const std::array<const char*, N>& names) {
  for (const char* name : names) {
    for (std::size_t i = 0; i < layer.fields.size(); ++i) {
      if (lower(layer.fields[i]) == name) return static_cast<int>(i);
    }
  }
  return -1;
}

std::string list_text(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

/// Reads the meaning of a layer's fields and shapes: names, places, trees, rows.
class PlanLayerReader {
 public:
  PlanLayerReader(const std::string& path, const VectorFile& file, const PlanFileOptions& options,
                  PlanFeatures& result)
      : path_(path), file_(file), options_(options), result_(result) {}

  void read(const VectorLayer& layer) {
    const Columns columns = columns_of(layer);
    note_crs(layer, columns);
    std::int64_t number = 0;
    for (const VectorFeature& feature : layer.features) {
      at_ = path_ + ": feature " + std::to_string(++number) +
            (is_folder() ? " of layer " + layer.name : std::string());
      add(feature, layer, columns);
    }
  }

  std::size_t num_left_out = 0;  ///< features that are neither points nor lines

 private:
  /// Indices of fields; -1: none.
  struct Columns {
    int row, tree, sd, name;
    int x, y;  ///< of a table
    bool is_table, is_in_degrees;
  };

  bool is_folder() const { return file_.layers.size() > 1; }

  int chosen(const VectorLayer& layer, const std::string& name, int usual) const {
    if (name.empty()) return usual;
    const auto found = std::find_if(layer.fields.begin(), layer.fields.end(),
                                    [&](const auto& f) { return lower(f) == lower(name); });
    if (found != layer.fields.end()) return static_cast<int>(found - layer.fields.begin());
    throw FileError(path_ + " has no column " + name + ", only: " + list_text(layer.fields));
  }

  Columns columns_of(const VectorLayer& layer) const {
    Columns c{};
    c.row = chosen(layer, options_.row_field, field_of(layer, kRowFields));
    c.tree = chosen(layer, options_.tree_field, field_of(layer, kTreeFields));
    c.sd = field_of(layer, kSdFields);
    c.name = field_of(layer, kLineNameFields);
    const int longitude = field_of(layer, kLongitudeFields);
    const int latitude = field_of(layer, kLatitudeFields);
    c.is_table = file_.driver == "CSV" && !layer.has_geometry;
    c.is_in_degrees = longitude >= 0 && latitude >= 0;
    c.x = c.is_in_degrees ? longitude : field_of(layer, kXFields);
    c.y = c.is_in_degrees ? latitude : field_of(layer, kYFields);
    if (c.is_table && (c.x < 0 || c.y < 0)) {
      throw FileError(
          path_ + " has no columns with positions (latitude and longitude, or x and y), only: " +
          list_text(layer.fields));
    }
    // if a drawing has several layers, each is a row
    const int drawing_layer =
        file_.driver == "DXF" ? field_of(layer, std::array<const char*, 1>{"layer"}) : -1;
    if (c.row < 0 && drawing_layer >= 0 && has_several(layer, drawing_layer)) c.row = drawing_layer;
    return c;
  }

  static bool has_several(const VectorLayer& layer, int field) {
    const auto i = static_cast<std::size_t>(field);
    return std::any_of(layer.features.begin(), layer.features.end(), [&](const auto& feature) {
      return feature.values[i] != layer.features.front().values[i];
    });
  }

  void note_crs(const VectorLayer& layer, const Columns& columns) {
    to_degrees_.reset();
    std::string crs = layer.crs, overruled = layer.overruled_crs;
    if (columns.is_table && columns.is_in_degrees && options_.crs.empty()) crs = kWgs84;
    if (columns.is_table && columns.is_in_degrees && crs != kWgs84) overruled = kWgs84;
    if (columns.is_table && !options_.crs.empty()) to_degrees_.emplace(options_.crs);
    if (!overruled.empty()) {
      result_.notes.push_back("the file states " + overruled + "; it is read as " + options_.crs +
                              ", as --crs says");
    }
    if (crs.empty()) return;
    result_.crs = crs;
    result_.is_geographic = true;
  }

  void add(const VectorFeature& feature, const VectorLayer& layer, const Columns& columns) {
    PlanFeature f;
    f.row = name_of(feature, columns.row);
    if (f.row.empty() && columns.row < 0 && is_folder()) f.row = layer.name;
    f.tree = name_of(feature, columns.tree);
    f.sd_m = sd_of(feature, layer, columns.sd);
    f.points = columns.is_table ? std::vector{place_in(feature, layer, columns)} : feature.points;
    for (const Vector2d& p : f.points) require_place(p);
    if (!columns.is_table && feature.shape == VectorShape::kNone) {
      throw FileError(at_ + " has no position; correct or delete it");
    }
    if (!columns.is_table && feature.shape == VectorShape::kOther) {
      ++num_left_out;
    } else if (f.points.size() == 1) {
      result_.trees.push_back(std::move(f));
    } else {
      if (f.row.empty()) f.row = name_of(feature, columns.name);
      result_.lines.push_back(std::move(f));
    }
  }

  double sd_of(const VectorFeature& feature, const VectorLayer& layer, int field) const {
    if (field < 0 || name_of(feature, field).empty()) return 0.0;
    const double sd_m = number_of(feature, layer, field);
    if (sd_m > 0.0 && sd_m <= kSdMax_m) return sd_m;
    throw FileError(at_ + ": its accuracy must be above 0 and at most " + fixed_text(kSdMax_m, 0) +
                    " m");
  }

  /// The place that a table's columns give.
  Vector2d place_in(const VectorFeature& feature, const VectorLayer& layer,
                    const Columns& columns) const {
    Vector2d p(number_of(feature, layer, columns.x), number_of(feature, layer, columns.y));
    if (to_degrees_ && !to_degrees_->convert(p)) {
      throw FileError(at_ + " is outside the area of " + result_.crs);
    }
    return p;
  }

  std::string name_of(const VectorFeature& feature, int field) const {
    if (field < 0) return {};
    std::string name = feature.values[static_cast<std::size_t>(field)];
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

  double number_of(const VectorFeature& feature, const VectorLayer& layer, int field) const {
    const std::string_view text = feature.values[static_cast<std::size_t>(field)];
    if (const auto value = parse_number<double>(text)) return *value;
    throw FileError(at_ + ": " + layer.fields[static_cast<std::size_t>(field)] + " = \"" +
                    std::string(text.substr(0, kLongestName)) + "\" is not a number");
  }

  void require_place(const Vector2d& p) const {
    const bool is_place = p.allFinite() && (!result_.is_geographic ||
                                            (std::abs(p.x()) <= 180.0 && std::abs(p.y()) <= 89.0));
    if (!is_place)
      throw FileError(at_ + " is not on the earth; check its coordinate system (--crs)");
  }

  const std::string& path_;
  const VectorFile& file_;
  const PlanFileOptions& options_;
  PlanFeatures& result_;
  std::optional<ToDegrees> to_degrees_;  ///< of a table
  std::string at_;
};

VectorFile read_layers(const std::string& path, const PlanFileOptions& options) {
  VectorFileOptions wanted;
  wanted.drivers = {"GPKG", "ESRI Shapefile", "GeoJSON", "LIBKML", "KML", "DXF",
                    "CSV",  "FlatGeobuf"};
  wanted.formats = "a GeoPackage, Shapefile, GeoJSON, KML, DXF, FlatGeobuf or CSV file";
  if (!options.layer.empty()) wanted.layers = {options.layer};
  wanted.crs = options.crs;
  wanted.widest_symbol_m = kWidestCrown_m;
  VectorFile file = read_vector_file(path, wanted);
  const std::string names = list_text(file.layer_names);
  if (file.layer_names.empty()) throw FileError(path + " has no layer");
  if (file.layers.empty() && !options.layer.empty()) {
    throw FileError(path + " has no layer " + options.layer + ", only: " + names);
  }
  if (file.layers.empty() || (file.layers.size() > 1 && !file.is_drawing())) {
    throw FileError(path + " has several layers; choose that of the plan with --layer: " + names);
  }
  return file;
}

bool is_yaml(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".yaml" || extension == ".yml";
}

}  // namespace

PlanFeatures read_plan_features(const std::string& path, const PlanFileOptions& options) {
  if (!std::filesystem::is_regular_file(path)) {
    throw FileError(path + (std::filesystem::exists(path) ? " is not a file" : " does not exist") +
                    "; give a plan (GeoPackage, Shapefile, GeoJSON, KML, DXF, CSV, or YAML)");
  }
  if (is_yaml(path)) return read_plan_grid(path);
  const VectorFile file = read_layers(path, options);
  PlanFeatures result;
  result.format = file.driver;
  result.crs = "local";
  PlanLayerReader reader(path, file, options, result);
  for (const VectorLayer& layer : file.layers) reader.read(layer);
  if (reader.num_left_out > 0) {
    result.notes.push_back(std::to_string(reader.num_left_out) +
                           " features that are neither points nor lines were ignored");
  }
  return result;
}

}  // namespace orchard::io
