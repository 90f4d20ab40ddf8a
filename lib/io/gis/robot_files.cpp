// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/robot_files.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "geometry/angles.hpp"
#include "geometry/thinned_line.hpp"
#include "mapping/extent/extent.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::ordered_json;

/// derived: of a line in the graph; far below kHalfCorridorMin_m, which every line has beside it.
constexpr double kTolerance_m = 0.05;

double rounded(double length_m) { return std::round(1e3 * length_m) / 1e3; }
Json place(const Eigen::Vector2d& p) { return {rounded(p.x()), rounded(p.y())}; }

/// The graph in straight pieces: each bend of a line is a node without a name.
struct Route {
  struct Node {
    Eigen::Vector2d p_map;
    std::string name;
    double width_m;  ///< of the narrowest line that begins or ends there
  };
  struct Piece {
    std::size_t from, to;
    const mapping::NavigationEdge* edge;
  };
  std::vector<Node> nodes;
  std::vector<Piece> pieces;
};

Route route_of(const mapping::NavigationGraph& graph, const mapping::RowNames& row_names) {
  std::map<std::int32_t, std::string> names;
  for (const mapping::NavigationEdge& edge : graph.edges) {
    if (edge.kind != mapping::EdgeKind::kAisle) continue;
    const std::string row = mapping::row_name(row_names, edge.row_left, "R");
    names[edge.from] = row + "_IN";
    names[edge.to] = row + "_OUT";
  }
  Route route;
  std::map<std::int32_t, std::size_t> indices;
  for (const mapping::NavigationNode& node : graph.nodes) {
    indices[node.id] = route.nodes.size();
    route.nodes.push_back({node.p_map, names[node.id], std::numeric_limits<double>::infinity()});
  }
  for (const mapping::NavigationEdge& edge : graph.edges) {
    const auto line = geometry::thinned_line(edge.line_map, kTolerance_m);
    std::size_t before = indices.at(edge.from);
    for (std::size_t i = 1; i < line.size(); ++i) {
      const bool is_end = i + 1 == line.size();
      if (!is_end) route.nodes.push_back({line[i], "", edge.width_m});
      const std::size_t node = is_end ? indices.at(edge.to) : route.nodes.size() - 1;
      for (const std::size_t end : {before, node}) {
        route.nodes[end].width_m = std::min(route.nodes[end].width_m, edge.width_m);
      }
      route.pieces.push_back({before, node, &edge});
      before = node;
    }
  }
  return route;
}

Json properties_of(const mapping::NavigationEdge& edge) {
  return {{"kind", edge.kind == mapping::EdgeKind::kAisle ? "aisle" : "headland"},
          {"row_left", edge.row_left},
          {"row_right", edge.row_right},
          {"width_m", edge.width_m}};
}

}  // namespace

std::string route_graph(const mapping::NavigationGraph& graph, const mapping::RowNames& row_names) {
  const Route route = route_of(graph, row_names);
  Json features = Json::array();
  const auto add = [&](const Json& properties, const char* type, const Json& coordinates) {
    features.push_back({{"type", "Feature"},
                        {"properties", properties},
                        {"geometry", {{"type", type}, {"coordinates", coordinates}}}});
  };
  std::size_t last_id = 0;
  for (const Route::Node& node : route.nodes) {
    Json properties{{"id", ++last_id}, {"frame", "map"}};
    if (!node.name.empty()) properties["metadata"] = {{"name", node.name}};
    add(properties, "Point", place(node.p_map));
  }
  for (const Route::Piece& piece : route.pieces) {
    for (const bool is_back : {false, true}) {
      const std::size_t from = is_back ? piece.to : piece.from;
      const std::size_t to = is_back ? piece.from : piece.to;
      const Eigen::Vector2d a = route.nodes[from].p_map, b = route.nodes[to].p_map;
      add({{"id", ++last_id},
           {"startid", from + 1},
           {"endid", to + 1},
           {"cost", rounded((b - a).norm())},
           {"metadata", properties_of(*piece.edge)}},
          "LineString", {place(a), place(b)});
    }
  }
  return Json{{"type", "FeatureCollection"}, {"features", features}}.dump() + "\n";
}

std::string topological_map(const mapping::NavigationGraph& graph,
                            const mapping::RowNames& row_names, const std::string& name,
                            std::int64_t utime) {
  const Route route = route_of(graph, row_names);
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const Route::Node& node : route.nodes) {
    const std::string wanted =
        node.name.empty() ? "N" + std::to_string(names.size() + 1) : node.name;
    names.push_back(wanted);
    for (int n = 2; !taken.insert(names.back()).second; ++n) {
      names.back() = wanted + "_" + std::to_string(n);
    }
  }
  std::vector<Json> edges(route.nodes.size(), Json::array());
  for (const Route::Piece& piece : route.pieces) {
    for (const bool is_back : {false, true}) {
      const std::size_t from = is_back ? piece.to : piece.from;
      const std::size_t to = is_back ? piece.from : piece.to;
      edges[from].push_back(
          {{"edge_id", names[from] + "_" + names[to]},
           {"node", names[to]},
           {"action", "NavigateToPose"},
           {"action_type", "geometry_msgs/PoseStamped"},
           {"goal",
            {{"target_pose",
              {{"pose", "$node.pose"}, {"header", {{"frame_id", "$node.parent_frame"}}}}}}},
           {"config", Json::array()},
           {"fail_policy", "fail"},
           {"fluid_navigation", true},
           {"recovery_behaviours_config", ""},
           {"restrictions_planning", "True"},
           {"restrictions_runtime", "True"},
           {"properties", properties_of(*piece.edge)}});
    }
  }
  Json nodes = Json::array();
  for (std::size_t i = 0; i < route.nodes.size(); ++i) {
    const Route::Node& node = route.nodes[i];
    Json zone = Json::array();
    constexpr int kCorners = 8;
    for (int k = 0; k < kCorners && std::isfinite(node.width_m); ++k) {
      const double angle = 2.0 * geometry::kPi * k / kCorners;
      zone.push_back({{"x", rounded(0.5 * node.width_m * std::cos(angle))},
                      {"y", rounded(0.5 * node.width_m * std::sin(angle))}});
    }
    nodes.push_back(
        {{"meta", {{"map", name}, {"node", names[i]}, {"pointset", name}}},
         {"node",
          {{"name", names[i]},
           {"parent_frame", "map"},
           {"localise_by_topic", ""},
           {"pose",
            {{"position",
              {{"x", rounded(node.p_map.x())}, {"y", rounded(node.p_map.y())}, {"z", 0.0}}},
             {"orientation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}}}},
           {"edges", edges[i]},
           {"restrictions_planning", "True"},
           {"restrictions_runtime", "True"},
           {"verts", zone}}}});
  }
  // To the second, in the schema's form.
  const auto time_s = static_cast<std::time_t>(utime / 1000000);
  std::tm utc{};
  ::gmtime_r(&time_s, &utc);
  char day[40];
  std::strftime(day, sizeof(day), "%Y-%m-%d_%H-%M-%S", &utc);
  return Json{{"meta", {{"last_updated", day}}},
              {"metric_map", name},
              {"name", name},
              {"pointset", name},
              {"transformation",
               {{"parent", "map"},
                {"child", "topo_map"},
                {"translation", {{"x", 0.0}, {"y", 0.0}, {"z", 0.0}}},
                {"rotation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}}}},
              {"nodes", nodes}}
             .dump(2) +
         "\n";
}

OccupancyGrid occupancy_grid(const std::vector<mapping::Landmark>& landmarks,
                             const mapping::NavigationGraph& graph,
                             const std::vector<std::vector<pose::PoseEstimate>>& paths,
                             const std::string& image_name) {
  // Of map_server's mode trinary; kFinest_m: as its tutorials have it.
  constexpr int kOccupied = 0, kUnknown = 205, kFree = 254;
  constexpr double kFinest_m = 0.05, kCellsMax = 1e8, kBorder_m = 2.0;
  std::vector<std::vector<Eigen::Vector2d>> outlines;
  std::vector<std::pair<std::vector<Eigen::Vector2d>, double>> ways;  // with their widths
  for (const mapping::Landmark& landmark : landmarks) {
    outlines.push_back(mapping::outline_of(landmark));
    if (outlines.back().empty()) outlines.back() = {{landmark.x_m, landmark.y_m}};
  }
  for (const auto& edge : graph.edges) ways.emplace_back(edge.line_map, edge.width_m);
  for (const auto& path : paths) {
    ways.push_back({{}, 2.0 * mapping::kHalfCorridorMin_m});
    for (const auto& pose : path) ways.back().first.emplace_back(pose.x_m, pose.y_m);
  }
  Eigen::AlignedBox2d box;
  for (const auto& outline : outlines)
    for (const auto& p : outline) box.extend(p);
  for (const auto& way : ways)
    for (const auto& p : way.first) box.extend(p);
  box.extend(box.min() - Eigen::Vector2d::Constant(kBorder_m));
  box.extend(box.max() + Eigen::Vector2d::Constant(kBorder_m));

  OccupancyGrid grid;
  grid.resolution_m = kFinest_m;
  while (box.volume() / (grid.resolution_m * grid.resolution_m) > kCellsMax) grid.resolution_m *= 2;
  const Eigen::Vector2d cells = box.sizes() / grid.resolution_m;
  cv::Mat1b image(static_cast<int>(std::ceil(cells.y())), static_cast<int>(std::ceil(cells.x())),
                  static_cast<std::uint8_t>(kUnknown));
  const auto pixels_of = [&](const std::vector<Eigen::Vector2d>& line) {
    std::vector<cv::Point> pixels;
    for (const Eigen::Vector2d& p : line) {
      const Eigen::Vector2d cell = (p - box.min()) / grid.resolution_m;
      pixels.emplace_back(static_cast<int>(cell.x()), image.rows - 1 - static_cast<int>(cell.y()));
    }
    return pixels;
  };
  for (const auto& [line, width_m] : ways) {
    const int thickness = std::max(1, static_cast<int>(width_m / grid.resolution_m));
    cv::polylines(image, pixels_of(line), false, kFree, thickness);
  }
  for (const auto& outline : outlines) cv::fillPoly(image, pixels_of(outline), kOccupied);

  grid.pgm = "P5\n" + std::to_string(image.cols) + " " + std::to_string(image.rows) + "\n255\n";
  grid.pgm.append(reinterpret_cast<const char*>(image.data), image.total());
  grid.yaml = "image: " + image_name +
              "\nmode: trinary\nresolution: " + fixed_text(grid.resolution_m, 2) + "\norigin: [" +
              fixed_text(box.min().x(), 3) + ", " + fixed_text(box.min().y(), 3) +
              ", 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  return grid;
}

std::string kitti_poses(const std::vector<pose::PoseEstimate>& path) {
  constexpr int kDecimals = 7;
  std::string text;
  for (const pose::PoseEstimate& pose : path) {
    const std::string cosine = fixed_text(std::cos(pose.yaw_rad), kDecimals);
    const double sine = std::sin(pose.yaw_rad);
    text += cosine + " " + fixed_text(-sine, kDecimals) + " 0 " + fixed_text(pose.x_m, 4) + " " +
            fixed_text(sine, kDecimals) + " " + cosine + " 0 " + fixed_text(pose.y_m, 4) +
            " 0 0 1 0\n";
  }
  return text;
}

}  // namespace orchard::io
