// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/map_layers.hpp"

#include <algorithm>
#include <cmath>

#include "detection/detection.hpp"
#include "geometry/angles.hpp"
#include "io/gis/geopackage.hpp"
#include "io/gis/qgis_style.hpp"
#include "mapping/extent/extent.hpp"
#include "mapping/inventory/inventory.hpp"
#include "mapping/kind.hpp"

namespace orchard::io {
namespace {

using detection::Label;

constexpr char kRed[] = "198,40,40", kGrey[] = "140,140,140";
constexpr char kBrown[] = "120,144,90", kBlue[] = "66,120,190", kOrange[] = "239,108,0";

GeoValue integer(std::int64_t value) { return value; }

/// Empty value for 0 (number not known).
GeoValue number_or_none(std::int32_t number) {
  return number == 0 ? GeoValue() : GeoValue(std::int64_t{number});
}

const char* kind_word(mapping::Kind kind) {
  return kind == mapping::Kind::kTree     ? "tree"
         : kind == mapping::Kind::kTrunk  ? "trunk"
         : kind == mapping::Kind::kObject ? "object"
                                          : "unseen";
}

/// Label for the user: row and tree such as "3/14", else "#id".
std::string label_of(const MapLayers& map, const mapping::Landmark& l) {
  if (l.row == 0 || l.position == 0) return "#" + std::to_string(l.id);
  return mapping::row_name(map.row_names, l.row) + "/" + std::to_string(l.position);
}

std::string note_of(const MapLayers& map, std::int32_t id) {
  const auto found = map.notes.find(id);
  std::string text;
  if (found == map.notes.end()) return text;
  for (const std::string& note : found->second) text += (text.empty() ? "" : "; ") + note;
  return text;
}

void write_landmarks(const MapLayers& map, LayerFile& file) {
  const std::optional<geometry::Georeference>& georeference = *map.georeference;
  GeoLayer layer{
      "landmarks",
      GeoGeometry::kPoint,
      "Trees and objects; kind: tree (in a row), trunk (in none), object, unseen; label: "
      "row/tree, or #id. Lengths in metres, diameter_mm and cross_section_cm2 of trees, or "
      "of all trunks in a map without rows",
      {{"id", GeoType::kInteger},
       {"class", GeoType::kText},
       {"x_m", GeoType::kReal},
       {"y_m", GeoType::kReal},
       {"n", GeoType::kInteger}},
      qml_text(landmark_style("\"label\"", "kind"))};
  for (const char* name : {"roc_mean", "probability", "se_x_m", "se_y_m", "width_m"}) {
    layer.fields.push_back({name, GeoType::kReal});
  }
  layer.fields.push_back({"row", GeoType::kInteger});
  layer.fields.push_back({"position", GeoType::kInteger});
  layer.fields.push_back({"width_sd_m", GeoType::kReal});
  layer.fields.push_back({"photo", GeoType::kText});
  if (georeference) {
    layer.fields.push_back({"latitude_deg", GeoType::kReal});
    layer.fields.push_back({"longitude_deg", GeoType::kReal});
  }
  layer.fields.push_back({"diameter_mm", GeoType::kReal});
  layer.fields.push_back({"cross_section_cm2", GeoType::kReal});
  layer.fields.push_back({"kind", GeoType::kText});
  layer.fields.push_back({"label", GeoType::kText});
  layer.fields.push_back({"note", GeoType::kText});
  layer.has_heights = std::any_of(map.landmarks->begin(), map.landmarks->end(),
                                  [](const auto& l) { return l.z_sd_m > 0.0; });
  if (layer.has_heights) {
    layer.fields.push_back({"z_m", GeoType::kReal});
    layer.fields.push_back({"z_sd_m", GeoType::kReal});
  }
  file.begin_layer(layer);
  const mapping::KindCounts kinds(*map.landmarks);
  for (const mapping::Landmark& l : *map.landmarks) {
    const Eigen::Vector2d p_map(l.x_m, l.y_m);
    const auto photo = map.photos.find(l.id);
    std::vector<GeoValue> values{integer(l.id),
                                 std::string(label_text(l.label)),
                                 l.x_m,
                                 l.y_m,
                                 integer(l.num_observations),
                                 l.roc_mean,
                                 l.probability,
                                 l.se_x_m,
                                 l.se_y_m,
                                 l.width_m,
                                 number_or_none(l.row),
                                 number_or_none(l.position),
                                 l.width_sd_m,
                                 photo == map.photos.end() ? GeoValue() : GeoValue(photo->second)};
    if (georeference) {
      const geometry::Geodetic place = geometry::geodetic_of(*georeference, p_map);
      values.push_back(place.latitude_deg);
      values.push_back(place.longitude_deg);
    }
    const mapping::Kind kind = mapping::kind_of(l);
    const bool is_counted = kinds.counts(kind) && l.width_m > 0.0;
    values.push_back(is_counted ? GeoValue(1e3 * l.width_m) : GeoValue());
    values.push_back(is_counted ? GeoValue(mapping::tcsa_cm2(l.width_m)) : GeoValue());
    values.push_back(std::string(kind_word(kind)));
    values.push_back(label_of(map, l));
    const std::string note = note_of(map, l.id);
    values.push_back(note.empty() ? GeoValue() : GeoValue(note));
    std::optional<double> height_m;
    if (l.z_sd_m > 0.0) height_m = l.z_m + (georeference ? georeference->altitude_m : 0.0);
    if (layer.has_heights) {
      values.push_back(height_m ? GeoValue(l.z_m) : GeoValue());
      values.push_back(height_m ? GeoValue(l.z_sd_m) : GeoValue());
    }
    file.add(values, {p_map}, height_m);
  }
}

/// Writes areas for landmarks with an extent: bushes, posts, hedges, walls.
void write_extents(const MapLayers& map, LayerFile& file) {
  QgisStyle style;
  style.is_area = true;
  style.symbols = {{"", "object", "solid", kRed, 0.2}};
  file.begin_layer({"extents",
                    GeoGeometry::kArea,
                    "Outlines of objects: bushes, hedges, walls, posts; id as in landmarks",
                    {{"id", GeoType::kInteger},
                     {"width_m", GeoType::kReal},
                     {"length_m", GeoType::kReal},
                     {"direction_deg", GeoType::kReal}},
                    qml_text(style)});
  for (const mapping::Landmark& l : *map.landmarks) {
    const std::vector<Eigen::Vector2d> border = mapping::outline_of(l);
    if (l.label != Label::kObject || border.empty()) continue;
    const bool is_long = l.length_m > 0.0;
    file.add({integer(l.id), l.width_m, is_long ? GeoValue(l.length_m) : GeoValue(),
              is_long ? GeoValue(l.direction_rad * 180.0 / geometry::kPi) : GeoValue()},
             border);
  }
}

/// Writes where no machine may drive: every landmark and a margin around it.
void write_keep_outs(const MapLayers& map, LayerFile& file) {
  QgisStyle style;
  style.is_area = true;
  style.symbols = {{"", "keep out", "solid", kRed, 0.2}};
  file.begin_layer(
      {"keep-outs",
       GeoGeometry::kArea,
       "Trees and objects with a margin around them; id as in landmarks",
       {{"id", GeoType::kInteger}, {"class", GeoType::kText}, {"margin_m", GeoType::kReal}},
       qml_text(style)});
  for (mapping::Landmark l : *map.landmarks) {
    l.width_m = std::max(0.0, l.width_m) + 2.0 * map.keep_out_m;
    if (l.length_m > 0.0) l.length_m += 2.0 * map.keep_out_m;
    file.add({integer(l.id), std::string(label_text(l.label)), map.keep_out_m},
             mapping::outline_of(l));
  }
}

void write_paths(const MapLayers& map, LayerFile& file) {
  QgisStyle style;
  style.is_line = true;
  style.symbols = {{"", "path", "solid", kGrey, 0.25}};
  file.begin_layer(
      {"path",
       GeoGeometry::kLine,
       "Path of the robot",
       {{"first_utime_us", GeoType::kInteger64}, {"last_utime_us", GeoType::kInteger64}},
       qml_text(style)});
  for (const auto* trajectory : map.trajectories) {
    if (trajectory->size() < 2) continue;  // no line
    std::vector<Eigen::Vector2d> line;
    for (const pose::PoseEstimate& pose : *trajectory) line.push_back({pose.x_m, pose.y_m});
    file.add({integer(trajectory->front().utime), integer(trajectory->back().utime)}, line);
  }
}

void write_rows(const MapLayers& map, LayerFile& file) {
  QgisStyle style;
  style.is_line = true;
  style.symbols = {{"", "row", "dash", kBrown, 0.35}};
  style.label = "'row ' || \"label\"";
  style.label_size_pt = 8.0;
  file.begin_layer({"rows",
                    GeoGeometry::kLine,
                    "Rows of trees, with their spacing [m]",
                    {{"row", GeoType::kInteger},
                     {"trees", GeoType::kInteger},
                     {"gaps", GeoType::kInteger},
                     {"spacing_m", GeoType::kReal},
                     {"spacing_least_m", GeoType::kReal},
                     {"spacing_most_m", GeoType::kReal},
                     {"spacing_sd_m", GeoType::kReal},
                     {"label", GeoType::kText}},
                    qml_text(style)});
  for (const mapping::Row& row : *map.rows) {
    std::vector<Eigen::Vector2d> line;
    for (const mapping::RowSlot& place : row.places) line.push_back(place.p_map);
    if (line.size() < 2) continue;
    const auto gaps = std::count_if(row.places.begin(), row.places.end(),
                                    [](const auto& place) { return place.landmark_id == 0; });
    const mapping::RowSpacing spacing = mapping::row_spacing(row);
    file.add({integer(row.number), integer(static_cast<std::int64_t>(line.size()) - gaps),
              integer(gaps), row.spacing_m, spacing.least_m, spacing.most_m, spacing.sd_m,
              mapping::row_name(map.row_names, row.number)},
             line);
  }
  style = QgisStyle{};
  style.symbols = {{"", "gap", "cross_fill", kOrange, 2.0}};
  style.label = "\"label\"";
  file.begin_layer(
      {"gaps",
       GeoGeometry::kPoint,
       "Gaps in rows: places without a tree",
       {{"row", GeoType::kInteger}, {"position", GeoType::kInteger}, {"label", GeoType::kText}},
       qml_text(style)});
  for (const mapping::Row& row : *map.rows) {
    for (const mapping::RowSlot& place : row.places) {
      if (place.landmark_id != 0) continue;
      file.add(
          {integer(row.number), integer(place.position),
           mapping::row_name(map.row_names, row.number) + "/" + std::to_string(place.position)},
          {place.p_map});
    }
  }
}

void write_graph(const mapping::NavigationGraph& graph, LayerFile& file) {
  for (const auto kind : {mapping::EdgeKind::kAisle, mapping::EdgeKind::kHeadland}) {
    const bool is_aisle = kind == mapping::EdgeKind::kAisle;
    QgisStyle style;
    style.is_line = true;
    style.symbols = {
        {"", is_aisle ? "aisle" : "headland", is_aisle ? "solid" : "dash", kBlue, 0.3}};
    file.begin_layer(
        {is_aisle ? "aisles" : "headlands",
         GeoGeometry::kLine,
         is_aisle ? "Aisles between rows, with the observed free width [m]"
                  : "Headland paths around the ends of rows, with the observed free width [m]",
         {{"edge", GeoType::kInteger},
          {"from_node", GeoType::kInteger},
          {"to_node", GeoType::kInteger},
          {is_aisle ? "row_left" : "row", GeoType::kInteger},
          {"row_right", GeoType::kInteger},
          {"length_m", GeoType::kReal},
          {"width_m", GeoType::kReal}},
         qml_text(style)});
    for (const mapping::NavigationEdge& edge : graph.edges) {
      if (edge.kind != kind) continue;
      file.add(
          {integer(edge.id), integer(edge.from), integer(edge.to), number_or_none(edge.row_left),
           number_or_none(edge.row_right), edge.length_m, edge.width_m},
          edge.line_map);
    }
  }
  QgisStyle style;
  style.symbols = {{"", "node", "circle", kBlue, 1.0}};
  file.begin_layer({"nodes",
                    GeoGeometry::kPoint,
                    "Nodes, where aisles and headland paths meet",
                    {{"node", GeoType::kInteger}},
                    qml_text(style)});
  for (const mapping::NavigationNode& node : graph.nodes) {
    file.add({integer(node.id)}, {node.p_map});
  }
}

}  // namespace

void write_map_layers(const MapLayers& layers, LayerFile& file) {
  if (layers.num_corrections > 0) {
    file.set_metadata(kCorrectionsMetadata, std::to_string(layers.num_corrections));
  }
  write_landmarks(layers, file);
  write_extents(layers, file);
  if (layers.keep_out_m > 0.0) write_keep_outs(layers, file);
  write_paths(layers, file);
  write_rows(layers, file);
  if (layers.graph != nullptr) write_graph(*layers.graph, file);
}

std::string map_geopackage(const MapLayers& layers) {
  GeoPackage file(*layers.georeference);
  write_map_layers(layers, file);
  return file.finish();
}

}  // namespace orchard::io
