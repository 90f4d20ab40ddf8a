// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/stored_map.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "io/file_error.hpp"
#include "io/map/graph_json.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/trajectory_csv.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using mapping::Landmark;
using Json = nlohmann::ordered_json;

constexpr double kWidestTrunk_m = 5.0;
constexpr double kWidestSpacing_m = 300.0;  ///< median distance to the nearest neighbour
constexpr double kNarrowestSpacing_m = 0.02;

/// Place of a landmark in a map.csv, which has a header and no empty lines.
std::string at_line(const std::string& name, std::size_t index) {
  return name + ":" + std::to_string(index + 2) + ": ";
}

void require_metres(const std::string& name, const std::vector<Landmark>& landmarks) {
  std::vector<double> widths_m;
  std::vector<Eigen::Vector2d> places;
  for (const Landmark& l : landmarks) {
    widths_m.push_back(l.width_m);
    places.push_back({l.x_m, l.y_m});
  }
  if (geometry::median(widths_m) > kWidestTrunk_m) {
    const auto wide = std::find_if(landmarks.begin(), landmarks.end(),
                                   [](const Landmark& l) { return l.width_m > kWidestTrunk_m; });
    throw FileError(at_line(name, static_cast<std::size_t>(wide - landmarks.begin())) +
                    "width_m = " + fixed_text(wide->width_m, 1) +
                    " is too wide for a trunk, like most others; the map seems to be in "
                    "millimetres, give it in metres");
  }
  const double spacing_m = geometry::typical_spacing_m(geometry::IndexedPoints(places));
  if (landmarks.size() < 3) return;
  if (spacing_m > 0.0 && spacing_m < kNarrowestSpacing_m) {
    throw FileError(at_line(name, 0) + "x_m, y_m: landmarks are " + fixed_text(spacing_m, 4) +
                    " apart; these seem to be degrees, give metres");
  }
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  for (const Eigen::Vector2d& p : places) {
    x0 = std::min(x0, p.x()), x1 = std::max(x1, p.x());
    y0 = std::min(y0, p.y()), y1 = std::max(y1, p.y());
  }
  if (std::max(x1 - x0, y1 - y0) < kNarrowestSpacing_m) {
    throw FileError(at_line(name, 0) + "x_m, y_m: the whole map spans " +
                    fixed_text(std::max(x1 - x0, y1 - y0), 4) +
                    "; these seem to be degrees, give metres");
  }
  // a spacing of 0 means that no landmark has a neighbour within 162 m
  if (spacing_m > kWidestSpacing_m || spacing_m == 0.0 || spacing_m > 100.0) {
    throw FileError(
        at_line(name, 0) +
        "x_m, y_m: landmarks are more than 100 apart; these seem to be millimetres, give metres");
  }
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

double number_in(const Json& json, const char* key, double lo, double hi, const std::string& name) {
  if (!json.contains(key) || !json[key].is_number()) {
    throw FileError(name + ": " + key + " is missing or not a number; map the log again");
  }
  const double value = json[key].get<double>();
  if (!std::isfinite(value) || value < lo || value > hi) {
    throw FileError(name + ": " + key + " = " + fixed_text(value, 3) +
                    " is out of range; map the log again");
  }
  return value;
}

void take_summary(const std::filesystem::path& path, StoredMap& map) {
  const std::string name = path.string();
  const Json json = Json::parse(text_of(path), nullptr, false);
  if (!json.is_object()) throw FileError(name + " is not a JSON object; map the log again");
  if (json.contains("next_id")) {
    map.next_id = std::max(
        map.next_id, static_cast<std::int32_t>(number_in(json, "next_id", 1, 2147483647.0, name)));
  }
  if (json.contains("view") && json["view"].is_object()) {
    const Json& view = json["view"];
    map.view.reach_m = number_in(view, "reach_m", 0.1, 500.0, name);
    map.view.bearing_min_rad = number_in(view, "bearing_min_rad", -7.0, 7.0, name);
    map.view.bearing_max_rad = number_in(view, "bearing_max_rad", -7.0, 7.0, name);
    map.view.mount_x_m = number_in(view, "mount_x_m", -100.0, 100.0, name);
    map.view.mount_y_m = number_in(view, "mount_y_m", -100.0, 100.0, name);
    map.view.mount_yaw_rad = number_in(view, "mount_yaw_rad", -7.0, 7.0, name);
    if (view.contains("min_observations")) {
      map.view.min_observations =
          static_cast<int>(number_in(view, "min_observations", 1, 1e6, name));
    }
  }
  if (json.contains("georeference") && json["georeference"].is_object()) {
    const Json& g = json["georeference"];
    geometry::Georeference georeference;
    georeference.latitude_deg = number_in(g, "latitude_deg", -90.0, 90.0, name);
    georeference.longitude_deg = number_in(g, "longitude_deg", -360.0, 360.0, name);
    georeference.altitude_m = number_in(g, "altitude_m", -1e5, 1e5, name);
    georeference.x_m = number_in(g, "x_m", -1e8, 1e8, name);
    georeference.y_m = number_in(g, "y_m", -1e8, 1e8, name);
    georeference.yaw_rad = number_in(g, "yaw_rad", -7.0, 7.0, name);
    georeference.residual_rms_m = number_in(g, "residual_rms_m", 0.0, 1e6, name);
    map.georeference = georeference;
  }
}

}  // namespace

StoredMap read_stored_map(const std::string& folder_or_csv) {
  namespace fs = std::filesystem;
  StoredMap map;
  const bool is_folder = fs::is_directory(folder_or_csv);
  const fs::path folder(folder_or_csv);
  map.name = is_folder ? (folder / "map.csv").string() : folder_or_csv;
  if (is_folder && !fs::exists(map.name)) {
    throw FileError(folder_or_csv + " has no map.csv; give a folder that `orchard map` wrote");
  }
  map.landmarks = read_map_csv(map.name);
  if (map.landmarks.empty()) {
    throw FileError(map.name + ":2: the map is empty, so no other map can be aligned with it");
  }
  require_metres(map.name, map.landmarks);
  for (const Landmark& l : map.landmarks) {
    map.next_id = std::max(map.next_id, l.id < 2147483647 ? l.id + 1 : l.id);
  }
  if (!is_folder) return map;
  if (fs::exists(folder / "summary.json")) take_summary(folder / "summary.json", map);
  if (fs::exists(folder / "graph.json"))
    map.graph = read_graph_json((folder / "graph.json").string());
  for (int k = 1;; ++k) {
    const fs::path path =
        folder / (k == 1 ? "trajectory.csv" : "trajectory_" + std::to_string(k) + ".csv");
    if (!fs::exists(path)) break;
    auto trajectory = read_trajectory_csv(path.string());
    if (!trajectory.empty()) map.trajectories.push_back(std::move(trajectory));
  }
  return map;
}

}  // namespace orchard::io
