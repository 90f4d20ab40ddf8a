// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/gis/plan_file.hpp"

namespace orchard::io {

/// A feature of a plan's file: a tree, or a row's line.
struct PlanFeature {
  std::string row, tree;  ///< empty: not named
  /// Longitude and latitude [degrees], or the file's own metres; one of a tree, more of a line.
  std::vector<Eigen::Vector2d> points;
};

struct PlanFeatures {
  std::string format;
  std::string crs;             ///< "local" for none
  bool is_geographic = false;  ///< points are longitude and latitude (WGS 84)
  std::vector<PlanFeature> trees, lines;
  std::vector<std::string> notes;
};

/// What a file that GDAL reads holds of trees and rows. Throws FileError.
PlanFeatures read_plan_features(const std::string& path, const PlanFileOptions& options);

/// The same of a regular grid described in YAML. Throws ConfigError, FileError.
PlanFeatures read_plan_grid(const std::string& path);

}  // namespace orchard::io
