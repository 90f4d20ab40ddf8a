// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/map_ways.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace orchard::mapping {
namespace {

/// derived: With 16 bytes a point, 45 a way and 20 a long object, a full part stays below 60 kB.
constexpr std::size_t kPoints = 2500, kWays = 200, kLongObjects = 400;

/// At most `num_max` points of a line, the first and last among them.
std::vector<WayPoint> thinned(const std::vector<Eigen::Vector2d>& line, std::size_t num_max) {
  const std::size_t num = std::min(line.size(), num_max);
  std::vector<WayPoint> points;
  for (std::size_t k = 0; k < num; ++k) {
    const Eigen::Vector2d& p = line[num < 2 ? 0 : k * (line.size() - 1) / (num - 1)];
    points.push_back({p.x(), p.y()});
  }
  return points;
}

}  // namespace

std::vector<MapWays> map_ways_of(const FinishedMap& map, std::int64_t utime) {
  std::vector<MapWays> parts(1);
  for (const Landmark& l : map.landmarks) {
    if (l.length_m <= 0.0) continue;
    if (parts.back().long_objects.size() >= kLongObjects) parts.emplace_back();
    parts.back().long_objects.push_back({l.id, l.length_m, l.direction_rad});
  }
  if (!parts.back().long_objects.empty()) parts.emplace_back();
  for (const NavigationEdge& edge : map.graph.edges) {
    const std::vector<WayPoint> line = thinned(edge.line_map, kPoints);
    if (parts.back().ways.size() >= kWays || parts.back().points.size() + line.size() > kPoints) {
      parts.emplace_back();
    }
    Way way{edge, static_cast<std::int32_t>(line.size())};
    way.edge.line_map.clear();
    parts.back().ways.push_back(std::move(way));
    parts.back().points.insert(parts.back().points.end(), line.begin(), line.end());
  }
  for (std::size_t k = 0; k < parts.size(); ++k) {
    parts[k].utime = utime;
    parts[k].part = static_cast<std::int32_t>(k);
    parts[k].num_parts = static_cast<std::int32_t>(parts.size());
  }
  return parts;
}

std::optional<MapWaysCollector::Result> MapWaysCollector::add(const MapWays& part) {
  const auto num_parts = static_cast<std::size_t>(part.num_parts);
  if (part.utime != utime_ || num_parts != parts_.size()) {
    parts_.assign(num_parts, std::nullopt);
    utime_ = part.utime;
  }
  parts_[static_cast<std::size_t>(part.part)] = part;
  const auto is_there = [](const auto& p) { return p.has_value(); };
  if (!std::all_of(parts_.begin(), parts_.end(), is_there)) return std::nullopt;
  Result result;
  result.utime = part.utime;
  std::map<std::int32_t, Eigen::Vector2d> nodes;
  for (const std::optional<MapWays>& p : parts_) {
    result.long_objects.insert(result.long_objects.end(), p->long_objects.begin(),
                               p->long_objects.end());
    std::size_t at = 0;
    for (const Way& way : p->ways) {
      NavigationEdge edge = way.edge;
      for (std::int32_t k = 0; k < way.num_points; ++k, ++at) {
        edge.line_map.push_back({p->points[at].x_m, p->points[at].y_m});
      }
      if (edge.line_map.empty()) continue;
      nodes.emplace(edge.from, edge.line_map.front());
      nodes.emplace(edge.to, edge.line_map.back());
      result.graph.edges.push_back(std::move(edge));
    }
  }
  for (const auto& [id, p_map] : nodes) result.graph.nodes.push_back({id, p_map});
  parts_.clear();
  return result;
}

}  // namespace orchard::mapping
