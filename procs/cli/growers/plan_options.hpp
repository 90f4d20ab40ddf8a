// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}
namespace orchard::io {
struct PlanFileOptions;
}
namespace orchard::mapping {
struct PlanMatchConfig;
}

namespace orchard::cli {

/// Options of every command that lays a plan on a map: how its file is read, what is out of place.
void add_plan_options(CLI::App& command, io::PlanFileOptions& file,
                      mapping::PlanMatchConfig& match);

}  // namespace orchard::cli
