// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mapping/rows/navigation_graph.hpp"

namespace orchard::io {

/// graph.json as text, for path planners: nodes with id and position, edges with kind, nodes, rows,
/// length, free width and line, in metres of the map frame.
std::string graph_json(const mapping::NavigationGraph& graph);

/// Reads a graph.json. Throws FileError naming the file and the first entry that is not as
/// graph_json() writes it.
mapping::NavigationGraph read_graph_json(const std::string& path);

}  // namespace orchard::io
