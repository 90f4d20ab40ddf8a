// SPDX-License-Identifier: BSD-3-Clause
#include "cli/add_command.hpp"
#include "cli/growers/report.hpp"

namespace orchard::cli {

/// Plans are read by the program that loads GDAL.
int run_report(const ReportOptions& options) {
  return options.plan_path.empty() ? write_report(options, {}) : replace_by_program("orchard-gis");
}

}  // namespace orchard::cli
