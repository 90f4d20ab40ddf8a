// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/graph_json.hpp"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "io/file_error.hpp"
#include "io/map/rounded.hpp"
#include "io/sane_limits.hpp"

namespace orchard::io {
namespace {

using Json = nlohmann::ordered_json;

Json place(const Eigen::Vector2d& p) { return {millimetres(p.x()), millimetres(p.y())}; }

/// Reads the entries of a graph.json and says which one is wrong.
class GraphReader {
 public:
  GraphReader(const Json& json, const std::string& path) : json_(json), path_(path) {}

  mapping::NavigationGraph read() {
    mapping::NavigationGraph graph;
    std::set<std::int32_t> nodes;
    for (const Json& node : list(json_, "nodes")) {
      graph.nodes.push_back({number(node, "id", 1), place_in(member(node, "place"))});
      if (!nodes.insert(graph.nodes.back().id).second) fail("a node's id occurs twice");
    }
    for (const Json& entry : list(json_, "edges")) {
      mapping::NavigationEdge edge;
      edge.id = number(entry, "id", 1);
      const Json& kind = member(entry, "kind");
      if (kind != "alley" && kind != "headland") fail("kind must be alley or headland");
      const bool is_alley = kind == "alley";
      edge.kind = is_alley ? mapping::EdgeKind::kAlley : mapping::EdgeKind::kHeadland;
      edge.from = number(entry, "from", 1);
      edge.to = number(entry, "to", 1);
      if (nodes.count(edge.from) + nodes.count(edge.to) < 2) fail("an edge has no such node");
      edge.row_left = number(entry, is_alley ? "row_left" : "row", 0);
      if (is_alley) edge.row_right = number(entry, "row_right", 0);
      edge.length_m = metres(member(entry, "length_m"), 0.0);
      edge.width_m = metres(member(entry, "width_m"), 0.0);
      for (const Json& p : list(entry, "line")) edge.line_map.push_back(place_in(p));
      if (edge.line_map.size() < 2) fail("a line needs two points");
      graph.edges.push_back(std::move(edge));
    }
    return graph;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(path_ + ": " + what + "; map the log again");
  }
  const Json& member(const Json& json, const char* key) const {
    if (!json.is_object() || !json.contains(key)) fail(std::string(key) + " is missing");
    return json[key];
  }
  const Json& list(const Json& json, const char* key) const {
    const Json& found = member(json, key);
    if (!found.is_array()) fail(std::string(key) + " must be a list");
    return found;
  }
  std::int32_t number(const Json& json, const char* key, std::int64_t min) const {
    const Json& value = member(json, key);
    if (!value.is_number_integer() || value < min || value > INT32_MAX) {
      fail(std::string(key) + " must be a whole number of " + std::to_string(min) + " or more");
    }
    return value.get<std::int32_t>();
  }
  double metres(const Json& json, double min_m) const {
    const double value_m = json.is_number() ? json.get<double>() : NAN;
    if (!(value_m >= min_m && value_m <= kMaxCoordinate_m)) fail("a length is out of range");
    return value_m;
  }
  Eigen::Vector2d place_in(const Json& json) const {
    if (!json.is_array() || json.size() != 2) fail("a place must be two numbers");
    return {metres(json[0], -kMaxCoordinate_m), metres(json[1], -kMaxCoordinate_m)};
  }

  const Json& json_;
  const std::string& path_;
};

}  // namespace

mapping::NavigationGraph read_graph_json(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const Json json = Json::parse(file, nullptr, false);
  if (!json.is_object()) throw FileError(path + " is not a JSON object; map the log again");
  return GraphReader(json, path).read();
}

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
