// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/gis/plan_file.hpp"

namespace orchard::io {

/// A feature of a plan file: a tree, or the line of a row.
struct PlanFeature {
  std::string row, tree;  ///< empty: no name
  /// Longitude and latitude [degrees], or coordinates in the file's metric system; one point for a
  /// tree, several for a line.
  std::vector<Eigen::Vector2d> points;
};

struct PlanFeatures {
  std::string format;
  std::string crs;             ///< "local" for none
  bool is_geographic = false;  ///< points are longitude and latitude (WGS 84)
  std::vector<PlanFeature> trees, lines;
  std::vector<std::string> notes;
};

/// Reads the trees and rows of a file through GDAL. Throws FileError.
PlanFeatures read_plan_features(const std::string& path, const PlanFileOptions& options);

/// Reads a regular grid described in YAML. Throws ConfigError, FileError.
PlanFeatures read_plan_grid(const std::string& path);

}  // namespace orchard::io
