// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/graph_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/map/rounded.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::ordered_json;

Json place(const Eigen::Vector2d& p) { return {millimetres(p.x()), millimetres(p.y())}; }

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
    const bool is_alley = edge.kind == mapping::EdgeKind::kAlley;
    Json line = Json::array();
    for (const Eigen::Vector2d& p : edge.line_map) line.push_back(place(p));
    Json entry{{"id", edge.id},
               {"kind", is_alley ? "alley" : "headland"},
               {"from", edge.from},
               {"to", edge.to}};
    if (is_alley) {
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

}  // namespace orchard::io
