// SPDX-License-Identifier: BSD-3-Clause
#include "view/map_data.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "geometry/thinned_line.hpp"
#include "mapping/kind.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

namespace orchard::view {
namespace {

using mapping::Landmark;

std::string row_json(const mapping::Row& row) {
  std::vector<const mapping::RowSlot*> gaps;
  for (const mapping::RowSlot& place : row.places) {
    if (place.landmark_id == 0) gaps.push_back(&place);
  }
  const auto gap_json = [](const mapping::RowSlot* gap) {
    return fmt::format("[{},{}]", gap->position, point_text(gap->p_map));
  };
  return fmt::format(R"({{"number":{},"first":{},"spacing":{},"line":{},"gaps":{}}})", row.number,
                     row.places.front().position, fixed_text(row.spacing_m, 3),
                     line_json(tree_line(row)), array_json(gaps, gap_json));
}

}  // namespace

int label_number(detection::Label label) {
  return label == detection::Label::kTree ? 0 : label == detection::Label::kObject ? 1 : 2;
}

int kind_number(const Landmark& landmark) {
  return mapping::kind_of(landmark) == mapping::Kind::kTrunk ? 3 : label_number(landmark.label);
}

std::string point_text(const Eigen::Vector2d& p) {
  return fixed_text(p.x(), 3) + "," + fixed_text(p.y(), 3);
}

std::string line_json(const std::vector<Eigen::Vector2d>& line) {
  return array_json(line, point_text);
}

std::vector<Eigen::Vector2d> tree_line(const mapping::Row& row) {
  std::vector<Eigen::Vector2d> line;
  for (const mapping::RowSlot& place : row.places) {
    if (place.landmark_id != 0) line.push_back(place.p_map);
  }
  return line;
}

std::vector<Eigen::Vector2d> path_line(const std::vector<pose::PoseEstimate>& path) {
  std::vector<Eigen::Vector2d> line;
  line.reserve(path.size());
  for (const pose::PoseEstimate& pose : path) line.emplace_back(pose.x_m, pose.y_m);
  return geometry::thinned_line(line, kPathTolerance_m);
}

std::string way_json(const mapping::NavigationEdge& way, const std::vector<Eigen::Vector2d>& line) {
  return fmt::format(R"({{"kind":"{}","width":{},"line":{}}})",
                     way.kind == mapping::EdgeKind::kAisle ? "aisle" : "headland",
                     fixed_text(way.width_m, 3), line_json(line));
}

std::string georeference_json(const geometry::Georeference& g) {
  return fmt::format(R"({{"latitude_deg":{},"longitude_deg":{},"yaw_rad":{},"residual_rms_m":{}}})",
                     fixed_text(g.latitude_deg, 8), fixed_text(g.longitude_deg, 8),
                     fixed_text(g.yaw_rad, 6), fixed_text(g.residual_rms_m, 3));
}

std::string json_text(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

std::string landmark_columns_json(const std::vector<Landmark>& landmarks,
                                  const std::optional<geometry::Georeference>& georeference) {
  std::string text = "{";
  const auto add = [&](const char* name, const auto& text_of) {
    if (text.size() > 1) text += ",";
    text += std::string("\"") + name + "\":" + array_json(landmarks, text_of);
  };
  const auto add_number = [&](const char* name, double Landmark::*value, int num_decimals) {
    add(name, [=](const Landmark& l) { return fixed_text(l.*value, num_decimals); });
  };
  add("id", [](const Landmark& l) { return std::to_string(l.id); });
  add("label", [](const Landmark& l) { return std::to_string(kind_number(l)); });
  add_number("x", &Landmark::x_m, 3);
  add_number("y", &Landmark::y_m, 3);
  add("n", [](const Landmark& l) { return std::to_string(l.num_observations); });
  add_number("roc", &Landmark::roc_mean, 3);
  add_number("probability", &Landmark::probability, 4);
  add_number("se_x", &Landmark::se_x_m, 4);
  add_number("se_y", &Landmark::se_y_m, 4);
  add_number("width", &Landmark::width_m, 4);
  add_number("width_sd", &Landmark::width_sd_m, 4);
  const auto is_long = [](const Landmark& l) { return l.length_m > 0.0; };
  if (std::any_of(landmarks.begin(), landmarks.end(), is_long)) {
    add_number("length", &Landmark::length_m, 3);
    add_number("direction", &Landmark::direction_rad, 4);
  }
  const auto has_height = [](const Landmark& l) { return l.z_sd_m > 0.0; };
  if (std::any_of(landmarks.begin(), landmarks.end(), has_height)) {
    add_number("z", &Landmark::z_m, 3);
    add_number("z_sd", &Landmark::z_sd_m, 4);
  }
  add("row", [](const Landmark& l) { return std::to_string(l.row); });
  add("position", [](const Landmark& l) { return std::to_string(l.position); });
  if (georeference) {
    const auto place = [&](const Landmark& l) {
      return geometry::geodetic_of(*georeference, {l.x_m, l.y_m});
    };
    add("latitude", [&](const Landmark& l) { return fixed_text(place(l).latitude_deg, 7); });
    add("longitude", [&](const Landmark& l) { return fixed_text(place(l).longitude_deg, 7); });
  }
  return text + "}";
}

std::string rows_and_ways_json(const std::vector<mapping::Row>& rows,
                               const mapping::NavigationGraph& graph) {
  return "\"rows\":" + array_json(rows, row_json) +
         ",\"ways\":" + array_json(graph.edges, [](const mapping::NavigationEdge& way) {
           return way_json(way, way.line_map);
         });
}

std::string names_and_notes_json(const std::map<std::int32_t, std::string>& row_names,
                                 const std::map<std::int32_t, std::vector<std::string>>& notes) {
  std::string text = "\"row_names\":{";
  for (const auto& [row, name] : row_names) {
    if (text.back() != '{') text += ',';
    text += "\"" + std::to_string(row) + "\":" + json_text(name);
  }
  text += "},\"notes\":{";
  for (const auto& [id, texts] : notes) {
    if (text.back() != '{') text += ',';
    text += "\"" + std::to_string(id) + "\":" + array_json(texts, json_text);
  }
  return text + "}";
}

std::string heading_json(const MapData& map_data) {
  std::string text =
      fmt::format(R"("title":{},"version":{},"first_utime":{},"last_utime":{},"warnings":{})",
                  json_text(map_data.title), json_text(map_data.version), map_data.first_utime,
                  map_data.last_utime, array_json(map_data.warnings, json_text));
  if (map_data.georeference) {
    text += ",\n\"georeference\":" + georeference_json(*map_data.georeference);
  }
  return text;
}

std::string names_and_photo_ids_json(const MapData& map_data) {
  return names_and_notes_json(map_data.row_names, map_data.notes) + ",\n\"photo_ids\":" +
         array_json(map_data.photo_ids, [](std::int32_t id) { return std::to_string(id); });
}

std::string background_json(const Background& b) {
  return fmt::format(
      R"("background":{{"box":[{:.3f},{:.3f},{:.3f},{:.3f}],"jpeg":"{}"}},)", b.low_map.x(),
      b.low_map.y(), b.high_map.x(), b.high_map.y(),
      base64_text(reinterpret_cast<const std::uint8_t*>(b.jpeg.data()), b.jpeg.size()));
}

std::string map_data_json(const MapData& map_data) {
  std::string text =
      "{" + heading_json(map_data) +
      ",\n\"landmarks\":" + landmark_columns_json(*map_data.landmarks, map_data.georeference) +
      ",\n" + rows_and_ways_json(*map_data.rows, *map_data.graph) + ",\n\"paths\":" +
      array_json(map_data.paths, [](const auto* path) { return line_json(path_line(*path)); }) +
      ",\n" + names_and_photo_ids_json(map_data) + ",\"photos\":{";
  const char* separator = "";
  for (const auto& [id, jpeg] : map_data.photographs) {
    text += separator + ("\"" + std::to_string(id)) + "\":\"" +
            base64_text(jpeg->data(), jpeg->size()) + "\"";
    separator = ",";
  }
  text += "}}";
  return text;
}

}  // namespace orchard::view
