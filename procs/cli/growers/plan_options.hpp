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

/// Adds the options of plan registration: format of the plan's file and limits of a misplaced tree.
void add_plan_options(CLI::App& command, io::PlanFileOptions& file,
                      mapping::PlanMatchConfig& match);

}  // namespace orchard::cli
