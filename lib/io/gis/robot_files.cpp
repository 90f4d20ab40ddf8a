// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/robot_files.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "geometry/thinned_line.hpp"
#include "mapping/extent/extent.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::ordered_json;

/// derived: of a line in the graph; far below kHalfCorridorMin_m, which every line has beside it.
constexpr double kTolerance_m = 0.05;

class RouteGraph {
 public:
  std::int32_t add_node(const Eigen::Vector2d& p_map, const std::string& name = {}) {
    Json properties{{"id", ++last_id_}, {"frame", "map"}};
    if (!name.empty()) properties["metadata"] = {{"name", name}};
    add(properties, {{"type", "Point"}, {"coordinates", place(p_map)}});
    return last_id_;
  }

  void add_edges(const Eigen::Vector2d& a, const Eigen::Vector2d& b, std::int32_t id_a,
                 std::int32_t id_b, const Json& metadata) {
    for (const bool is_back : {false, true}) {
      add({{"id", ++last_id_},
           {"startid", is_back ? id_b : id_a},
           {"endid", is_back ? id_a : id_b},
           {"cost", rounded((b - a).norm())},
           {"metadata", metadata}},
          {{"type", "LineString"},
           {"coordinates", {place(is_back ? b : a), place(is_back ? a : b)}}});
    }
  }

  std::string text() const {
    return Json{{"type", "FeatureCollection"}, {"features", features_}}.dump() + "\n";
  }

 private:
  static double rounded(double length_m) { return std::round(1e3 * length_m) / 1e3; }
  static Json place(const Eigen::Vector2d& p) { return {rounded(p.x()), rounded(p.y())}; }
  void add(const Json& properties, const Json& geometry) {
    features_.push_back({{"type", "Feature"}, {"properties", properties}, {"geometry", geometry}});
  }

  std::int32_t last_id_ = 0;
  Json features_ = Json::array();
};

}  // namespace

std::string route_graph(const mapping::NavigationGraph& graph, const mapping::RowNames& row_names) {
  RouteGraph route;
  std::map<std::int32_t, std::string> names;
  for (const mapping::NavigationEdge& edge : graph.edges) {
    if (edge.kind != mapping::EdgeKind::kAisle) continue;
    const std::string row = mapping::row_name(row_names, edge.row_left, "R");
    names[edge.from] = row + "_IN";
    names[edge.to] = row + "_OUT";
  }
  std::map<std::int32_t, std::int32_t> ids;
  for (const mapping::NavigationNode& node : graph.nodes) {
    ids[node.id] = route.add_node(node.p_map, names[node.id]);
  }
  for (const mapping::NavigationEdge& edge : graph.edges) {
    const bool is_aisle = edge.kind == mapping::EdgeKind::kAisle;
    const Json metadata{{"kind", is_aisle ? "aisle" : "headland"},
                        {"row_left", edge.row_left},
                        {"row_right", edge.row_right},
                        {"width_m", edge.width_m}};
    const auto line = geometry::thinned_line(edge.line_map, kTolerance_m);
    std::int32_t before = ids.at(edge.from);
    for (std::size_t i = 1; i < line.size(); ++i) {
      const bool is_end = i + 1 == line.size();
      const std::int32_t node = is_end ? ids.at(edge.to) : route.add_node(line[i]);
      route.add_edges(line[i - 1], line[i], before, node, metadata);
      before = node;
    }
  }
  return route.text();
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
