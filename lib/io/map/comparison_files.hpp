// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/figure/comparison_figure.hpp"

namespace orchard::io {

/// compare.json as text: the changes, the alignment and the counts; lengths in metres.
std::string comparison_json(const ComparisonContent& content);

/// Writes compare.csv, compare.gpkg (a point layer `changes`), compare.svg, compare.png and
/// compare.json into `folder` (created if missing), all or none. Throws FileError.
void write_comparison_folder(const std::string& folder, const ComparisonContent& content);

}  // namespace orchard::io
