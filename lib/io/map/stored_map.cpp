// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/stored_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "io/atomic_file.hpp"
#include "io/file_error.hpp"
#include "io/json_value.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/plan_names.hpp"
#include "io/map/rounded.hpp"
#include "io/sane_limits.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::ordered_json;
using mapping::Landmark;

Json place(const Eigen::Vector2d& p) { return {millimetres(p.x()), millimetres(p.y())}; }

constexpr const char* kAdvice = "map the log again";

/// Parses a file of a map, an object.
Json parsed(const std::string& path) {
  constexpr std::size_t kBytesMax = std::size_t{64} << 20;
  Json json = Json::parse(read_file(path, kBytesMax, kAdvice), nullptr, false);
  if (!json.is_object()) throw FileError(path + " is not a JSON object; " + kAdvice);
  return json;
}

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

void take_summary(const JsonValue& json, StoredMap& map) {
  if (json.has("next_id")) map.next_id = std::max(map.next_id, json.whole("next_id", 1));
  if (json.has("view")) {
    const JsonValue view = json.at("view");
    map.view.reach_m = view.number("reach_m", 0.1, 500.0);
    map.view.bearing_min_rad = view.number("bearing_min_rad", -7.0, 7.0);
    map.view.bearing_max_rad = view.number("bearing_max_rad", -7.0, 7.0);
    map.view.mount_x_m = view.number("mount_x_m", -100.0, 100.0);
    map.view.mount_y_m = view.number("mount_y_m", -100.0, 100.0);
    map.view.mount_yaw_rad = view.number("mount_yaw_rad", -7.0, 7.0);
    if (view.has("min_observations")) {
      map.view.min_observations = static_cast<int>(view.number("min_observations", 1, 1e6));
    }
  }
  if (json.has("georeference")) {
    const JsonValue g = json.at("georeference");
    geometry::Georeference& georeference = map.georeference.emplace();
    georeference.latitude_deg = g.number("latitude_deg", -90.0, 90.0);
    georeference.longitude_deg = g.number("longitude_deg", -360.0, 360.0);
    georeference.altitude_m = g.number("altitude_m", -1e5, 1e5);
    georeference.x_m = g.number("x_m", -kMaxCoordinate_m, kMaxCoordinate_m);
    georeference.y_m = g.number("y_m", -kMaxCoordinate_m, kMaxCoordinate_m);
    georeference.yaw_rad = g.number("yaw_rad", -7.0, 7.0);
    georeference.residual_rms_m = g.number("residual_rms_m", 0.0, 1e6);
  }
}

constexpr double kUtimeMax = 9e18;  // derived: fits into 64 bits

void add_interval(const JsonValue& interval, std::string_view fix_channel, SummaryFacts& facts) {
  const double duration_s = 1e-6 * (interval.number("last_utime_us", -kUtimeMax, kUtimeMax) -
                                    interval.number("first_utime_us", -kUtimeMax, kUtimeMax));
  if (!(duration_s >= 0.0)) return;
  if (interval.text("missing") == fix_channel) {
    facts.without_fixes_s += duration_s;
    return;
  }
  facts.without_pictures_s += duration_s;
  if (!interval.has("first_landmark")) return;
  const std::int32_t first = interval.whole("first_landmark", 1);
  facts.num_met_without_pictures += interval.whole("last_landmark", first) - first + 1;
}

/// Reads a graph.json. Throws FileError naming the file and the first entry that is not as
/// graph_json() writes it.
mapping::NavigationGraph read_graph_json(const std::string& path) {
  const Json json = parsed(path);
  const JsonSource source{path, kAdvice};
  const JsonValue file(json, source);
  mapping::NavigationGraph graph;
  std::set<std::int32_t> nodes;
  for (const JsonValue& node : file.list("nodes")) {
    graph.nodes.push_back({node.whole("id", 1), node.at("place").place()});
    if (!nodes.insert(graph.nodes.back().id).second) node.fail("a node's id occurs twice");
  }
  for (const JsonValue& entry : file.list("edges")) {
    mapping::NavigationEdge edge;
    edge.id = entry.whole("id", 1);
    const std::string kind = entry.text("kind");
    const bool is_aisle = kind == "aisle" || kind == "alley";  // "alley" until version 0.1
    if (!is_aisle && kind != "headland") entry.fail("kind must be aisle or headland");
    edge.kind = is_aisle ? mapping::EdgeKind::kAisle : mapping::EdgeKind::kHeadland;
    edge.from = entry.whole("from", 1);
    edge.to = entry.whole("to", 1);
    if (nodes.count(edge.from) + nodes.count(edge.to) < 2) entry.fail("an edge has no such node");
    edge.row_left = entry.whole(is_aisle ? "row_left" : "row", 0);
    if (is_aisle) edge.row_right = entry.whole("row_right", 0);
    edge.length_m = entry.number("length_m", 0.0, kMaxCoordinate_m);
    edge.width_m = entry.number("width_m", 0.0, kMaxCoordinate_m);
    for (const JsonValue& p : entry.list("line")) edge.line_map.push_back(p.place());
    if (edge.line_map.size() < 2) entry.fail("a line needs two points");
    graph.edges.push_back(std::move(edge));
  }
  return graph;
}

}  // namespace

std::string graph_json(const mapping::NavigationGraph& graph) {
  Json json;
  json["frame"] = "map";
  json["unit"] = "m";
  json["nodes"] = Json::array();
  for (const mapping::NavigationNode& node : graph.nodes) {
    json["nodes"].push_back({{"id", node.id}, {"place", place(node.p_map)}});
  }
  json["edges"] = Json::array();
  for (const mapping::NavigationEdge& edge : graph.edges) {
    const bool is_aisle = edge.kind == mapping::EdgeKind::kAisle;
    Json line = Json::array();
    for (const Eigen::Vector2d& p : edge.line_map) line.push_back(place(p));
    Json entry{{"id", edge.id},
               {"kind", is_aisle ? "aisle" : "headland"},
               {"from", edge.from},
               {"to", edge.to}};
    if (is_aisle) {
      entry["row_left"] = edge.row_left;
      entry["row_right"] = edge.row_right;
    } else {
      entry["row"] = edge.row_left;
    }
    entry["length_m"] = millimetres(edge.length_m);
    entry["width_m"] = millimetres(edge.width_m);
    entry["line"] = std::move(line);
    json["edges"].push_back(std::move(entry));
  }
  return json.dump(1) + "\n";
}

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
  if (const std::string path = (folder / "summary.json").string(); fs::exists(path)) {
    take_summary({parsed(path), {path, kAdvice}}, map);
  }
  if (fs::exists(folder / "graph.json"))
    map.graph = read_graph_json((folder / "graph.json").string());
  if (fs::exists(folder / "names.csv")) {
    map.plan_names = read_plan_names((folder / "names.csv").string());
  }
  for (int k = 1;; ++k) {
    const fs::path path =
        folder / (k == 1 ? "trajectory.csv" : "trajectory_" + std::to_string(k) + ".csv");
    if (!fs::exists(path)) break;
    auto trajectory = read_trajectory_csv(path.string());
    if (!trajectory.empty()) map.trajectories.push_back(std::move(trajectory));
  }
  return map;
}

SummaryFacts read_summary_facts(const std::string& folder_or_csv, std::string_view fix_channel,
                                const std::string& scan_count, const std::string& picture_count) {
  namespace fs = std::filesystem;
  fs::path folder(folder_or_csv);
  if (!fs::is_directory(folder)) folder = folder.parent_path();
  const fs::path path = folder / "summary.json";
  SummaryFacts facts;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return facts;
  constexpr std::size_t kWarningsMax = 20, kWarningLengthMax = 400;  // derived: a page of them
  const std::string name = path.string();
  const Json json = parsed(name);
  const JsonSource source{name, kAdvice};
  const JsonValue summary(json, source);
  if (summary.has("first_utime_us")) {
    facts.day = date_text(
        static_cast<std::int64_t>(summary.number("first_utime_us", -kUtimeMax, kUtimeMax)));
  }
  if (summary.has("version")) facts.version = printable_text(summary.text("version"));
  if (json.contains("counts") && json["counts"].contains(scan_count)) {
    facts.has_pictures = json["counts"].contains(picture_count);
  }
  if (summary.has("degraded")) {
    for (const JsonValue& interval : summary.list("degraded")) {
      add_interval(interval, fix_channel, facts);
    }
  }
  if (summary.has("warnings")) {
    for (const Json& warning : json["warnings"]) {
      if (!warning.is_string() || facts.warnings.size() >= kWarningsMax) continue;
      facts.warnings.push_back(
          printable_text(warning.get<std::string>().substr(0, kWarningLengthMax)));
    }
  }
  return facts;
}

}  // namespace orchard::io
