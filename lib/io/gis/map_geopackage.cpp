// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/map_geopackage.hpp"

#include <algorithm>

#include "detection/label_text.hpp"
#include "io/gis/geopackage.hpp"

namespace orchard::io {
namespace {

GeoValue integer(std::int64_t value) { return value; }

/// Numbers that are not known yet are 0.
GeoValue number_or_none(std::int32_t number) {
  return number == 0 ? GeoValue() : GeoValue(std::int64_t{number});
}

void write_landmarks(const std::vector<mapping::Landmark>& landmarks,
                     const std::optional<geometry::Georeference>& georeference,
                     const std::map<std::int32_t, std::string>& photos, GeoPackage& file) {
  std::vector<GeoField> fields{{"id", GeoType::kInteger},
                               {"class", GeoType::kText},
                               {"x_m", GeoType::kReal},
                               {"y_m", GeoType::kReal},
                               {"n", GeoType::kInteger}};
  for (const char* name : {"roc_mean", "probability", "se_x_m", "se_y_m", "width_m"}) {
    fields.push_back({name, GeoType::kReal});
  }
  fields.push_back({"row", GeoType::kInteger});
  fields.push_back({"position", GeoType::kInteger});
  fields.push_back({"width_sd_m", GeoType::kReal});
  fields.push_back({"photo", GeoType::kText});
  if (georeference) {
    fields.push_back({"latitude_deg", GeoType::kReal});
    fields.push_back({"longitude_deg", GeoType::kReal});
  }
  file.begin_layer("landmarks", GeoGeometry::kPoint, fields);
  for (const mapping::Landmark& l : landmarks) {
    const Eigen::Vector2d p_map(l.x_m, l.y_m);
    const auto photo = photos.find(l.id);
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
                                 photo == photos.end() ? GeoValue() : GeoValue(photo->second)};
    if (georeference) {
      const geometry::Geodetic place = geometry::geodetic_of(*georeference, p_map);
      values.push_back(place.latitude_deg);
      values.push_back(place.longitude_deg);
    }
    file.add(values, {p_map});
  }
}

void write_path(const std::vector<pose::PoseEstimate>& trajectory, GeoPackage& file) {
  file.begin_layer(
      "path", GeoGeometry::kLine,
      {{"first_utime_us", GeoType::kInteger64}, {"last_utime_us", GeoType::kInteger64}});
  if (trajectory.size() < 2) return;  // no line
  std::vector<Eigen::Vector2d> line;
  for (const pose::PoseEstimate& pose : trajectory) line.push_back({pose.x_m, pose.y_m});
  file.add({integer(trajectory.front().utime), integer(trajectory.back().utime)}, line);
}

void write_rows(const std::vector<mapping::Row>& rows, GeoPackage& file) {
  file.begin_layer("rows", GeoGeometry::kLine,
                   {{"row", GeoType::kInteger},
                    {"trees", GeoType::kInteger},
                    {"gaps", GeoType::kInteger},
                    {"spacing_m", GeoType::kReal},
                    {"spacing_least_m", GeoType::kReal},
                    {"spacing_most_m", GeoType::kReal},
                    {"spacing_sd_m", GeoType::kReal}});
  for (const mapping::Row& row : rows) {
    std::vector<Eigen::Vector2d> line;
    for (const mapping::RowPlace& place : row.places) line.push_back(place.p_map);
    if (line.size() < 2) continue;
    const auto gaps = std::count_if(row.places.begin(), row.places.end(),
                                    [](const auto& place) { return place.landmark_id == 0; });
    const mapping::RowSpacing spacing = mapping::row_spacing(row);
    file.add({integer(row.number), integer(static_cast<std::int64_t>(line.size()) - gaps),
              integer(gaps), row.spacing_m, spacing.least_m, spacing.most_m, spacing.sd_m},
             line);
  }
  file.begin_layer("gaps", GeoGeometry::kPoint,
                   {{"row", GeoType::kInteger}, {"position", GeoType::kInteger}});
  for (const mapping::Row& row : rows) {
    for (const mapping::RowPlace& place : row.places) {
      if (place.landmark_id != 0) continue;
      file.add({integer(row.number), integer(place.position)}, {place.p_map});
    }
  }
}

void write_graph(const mapping::NavigationGraph& graph, GeoPackage& file) {
  for (const auto kind : {mapping::WayKind::kAlley, mapping::WayKind::kHeadland}) {
    const bool is_alley = kind == mapping::WayKind::kAlley;
    file.begin_layer(is_alley ? "alleys" : "headlands", GeoGeometry::kLine,
                     {{"edge", GeoType::kInteger},
                      {"from_node", GeoType::kInteger},
                      {"to_node", GeoType::kInteger},
                      {is_alley ? "row_left" : "row", GeoType::kInteger},
                      {"row_right", GeoType::kInteger},
                      {"length_m", GeoType::kReal},
                      {"width_m", GeoType::kReal}});
    for (const mapping::NavigationEdge& edge : graph.edges) {
      if (edge.kind != kind) continue;
      file.add(
          {integer(edge.id), integer(edge.from), integer(edge.to), number_or_none(edge.row_left),
           number_or_none(edge.row_right), edge.length_m, edge.width_m},
          edge.line_map);
    }
  }
  file.begin_layer("nodes", GeoGeometry::kPoint, {{"node", GeoType::kInteger}});
  for (const mapping::NavigationNode& node : graph.nodes) {
    file.add({integer(node.id)}, {node.p_map});
  }
}

}  // namespace

std::string map_geopackage(const std::vector<mapping::Landmark>& landmarks,
                           const std::vector<pose::PoseEstimate>& trajectory,
                           const std::vector<mapping::Row>& rows,
                           const mapping::NavigationGraph& graph,
                           const std::optional<geometry::Georeference>& georeference,
                           const std::map<std::int32_t, std::string>& photos) {
  GeoPackage file(georeference);
  write_landmarks(landmarks, georeference, photos, file);
  write_path(trajectory, file);
  write_rows(rows, file);
  write_graph(graph, file);
  return file.finish();
}

}  // namespace orchard::io
