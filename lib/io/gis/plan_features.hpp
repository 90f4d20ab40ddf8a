// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "io/gis/plan_file.hpp"

namespace orchard::io {

/// A feature of a plan file: a tree, or the line of a row.
struct PlanFeature {
  std::string row, tree;  ///< empty: no name
  /// Longitude and latitude [degrees], or coordinates in the file's metric system; one point for a
  /// tree, several for a line.
  std::vector<Eigen::Vector2d> points;
  double sd_m = 0.0;  ///< of a tree's place; 0: not stated
};

struct PlanFeatures {
  std::string format;
  std::string crs;             ///< "local" for none
  bool is_geographic = false;  ///< points are longitude and latitude (WGS 84)
  std::vector<PlanFeature> trees, lines;
  std::vector<std::string> notes;
};

/// Reads the trees and rows of a file: YAML, or a file of read_vector_file(). Throws FileError,
/// ConfigError.
PlanFeatures read_plan_features(const std::string& path, const PlanFileOptions& options);

/// Reads a regular grid described in YAML. Throws FileError, ConfigError.
PlanFeatures read_plan_grid(const std::string& path);

}  // namespace orchard::io
