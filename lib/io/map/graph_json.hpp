// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mapping/rows/navigation_graph.hpp"

namespace orchard::io {

/// graph.json as text, for path planners: nodes with id and position, edges with kind, nodes, rows,
/// length, free width and line, in metres of the map frame.
std::string graph_json(const mapping::NavigationGraph& graph);

}  // namespace orchard::io
