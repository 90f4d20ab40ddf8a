// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/figure/comparison_figure.hpp"

namespace orchard::io {

/// compare.csv as text: change,confidence,id_a,id_b,class_a,class_b,x_m,y_m,moved_m,width_a_m,
/// width_b_m,width_change_m,width_change_se_m,row,position. Positions are in the frame of the
/// earlier map.
std::string comparison_csv(const ComparisonContent& content);

/// compare.json as text: the same with the alignment and the counts; lengths in metres.
std::string comparison_json(const ComparisonContent& content);

/// Writes compare.csv, compare.gpkg (a point layer `changes`), compare.svg, compare.png and
/// compare.json into `folder` (created if missing), all or none. Throws FileError.
void write_comparison_folder(const std::string& folder, const ComparisonContent& content);

}  // namespace orchard::io
