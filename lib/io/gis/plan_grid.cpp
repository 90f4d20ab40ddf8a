// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "geometry/angles.hpp"
#include "io/atomic_file.hpp"
#include "io/config/config_yaml.hpp"
#include "io/file_error.hpp"
#include "io/gis/plan_features.hpp"
#include "text/number_text.hpp"

namespace orchard::io {
namespace {

using Eigen::Vector2d;

constexpr double kSpacingMin_m = 0.2, kSpacingMax_m = 100.0;  // physical: of what is planted

enum class RowsTo { kRight, kLeft };

/// A regular grid, for example 12 rows, 4.5 m apart, 40 trees every 3 m, from a corner.
struct PlanGrid {
  int rows = 0;
  int trees = 0;
  double row_spacing_m = 0.0;
  double tree_spacing_m = 0.0;
  std::vector<double> corner_deg, row_end_deg;
  double bearing_deg = 0.0;
  RowsTo rows_to = RowsTo::kRight;
  int first_row = 1;
  int first_tree = 1;
};

void describe(ConfigVisitor& v, PlanGrid& g) {
  v.integer("rows", g.rows, 1, 100000, "", "number of rows");
  v.integer("trees", g.trees, 1, 100000, "", "number of trees per row");
  v.number("row_spacing_m", g.row_spacing_m, kSpacingMin_m, kSpacingMax_m, "m",
           "distance between rows");
  v.number("tree_spacing_m", g.tree_spacing_m, kSpacingMin_m, kSpacingMax_m, "m",
           "distance between the trees of a row");
  v.numbers("corner_deg", g.corner_deg, -180.0, 180.0, "degrees",
            "latitude and longitude of the first tree of the first row; without it the plan is not "
            "georeferenced");
  v.numbers("row_end_deg", g.row_end_deg, -180.0, 180.0, "degrees",
            "latitude and longitude of the last tree of the first row, in place of bearing_deg and "
            "tree_spacing_m");
  v.number("bearing_deg", g.bearing_deg, -360.0, 360.0, "degrees",
           "bearing of the rows from the first to the last tree, clockwise from north");
  v.choice("rows_to", g.rows_to, {"right", "left"},
           "side of the second row, looking along the first");
  v.integer("first_row", g.first_row, 1, 1000000, "", "number of the first row");
  v.integer("first_tree", g.first_tree, 1, 1000000, "", "number of the first tree of each row");
  v.check(g.rows > 0, "rows", "is missing: the number of rows");
  v.check(g.trees > 0, "trees", "is missing: the number of trees per row");
  v.check(g.row_spacing_m > 0.0, "row_spacing_m", "is missing: the distance between rows");
  const bool has_end = !g.row_end_deg.empty();
  v.check(has_end || g.tree_spacing_m > 0.0, "tree_spacing_m",
          "is missing: the distance between the trees of a row");
  v.check(
      !has_end || (g.tree_spacing_m == 0.0 && g.bearing_deg == 0.0), "row_end_deg",
      "gives the bearing and the spacing of the trees; leave bearing_deg and tree_spacing_m out");
  v.check(!has_end || (g.trees > 1 && !g.corner_deg.empty()), "row_end_deg",
          "needs corner_deg and at least two trees per row");
  const auto is_place = [](const std::vector<double>& p) {
    return p.empty() || (p.size() == 2 && std::abs(p[0]) <= 90.0);
  };
  v.check(is_place(g.corner_deg), "corner_deg", "must be [latitude, longitude]");
  v.check(is_place(g.row_end_deg), "row_end_deg", "must be [latitude, longitude]");
  v.check(static_cast<double>(g.rows) * g.trees <= 2e6, "trees",
          "gives more than two million trees");
}

}  // namespace

PlanFeatures read_plan_grid(const std::string& path) {
  constexpr std::size_t kBytesMax = std::size_t{1} << 20;
  PlanGrid grid;
  PlanFeatures features;
  features.notes = read_yaml(read_file(path, kBytesMax, "give a plan"), path,
                             [&](ConfigVisitor& v) { describe(v, grid); });
  features.format = "YAML";
  features.is_geographic = !grid.corner_deg.empty();
  features.crs = features.is_geographic ? "EPSG:4326" : "local";
  geometry::Georeference corner;
  if (features.is_geographic) {
    corner.latitude_deg = grid.corner_deg[0];
    corner.longitude_deg = grid.corner_deg[1];
  }
  const double bearing_rad = grid.bearing_deg * geometry::kPi / 180.0;
  Vector2d along(std::sin(bearing_rad), std::cos(bearing_rad));
  if (!grid.row_end_deg.empty()) {
    const Vector2d row =
        geometry::map_of(corner, geometry::Geodetic{grid.row_end_deg[0], grid.row_end_deg[1]});
    grid.tree_spacing_m = row.norm() / (grid.trees - 1);
    if (!(grid.tree_spacing_m >= kSpacingMin_m && grid.tree_spacing_m <= kSpacingMax_m)) {
      throw FileError(path + ": row_end_deg is " + fixed_text(row.norm(), 1) +
                      " m from corner_deg, which gives " + fixed_text(grid.tree_spacing_m, 2) +
                      " m between trees; correct the places or trees");
    }
    along = row.normalized();
  }
  const Vector2d right(along.y(), -along.x());
  const Vector2d step = (grid.rows_to == RowsTo::kRight ? 1.0 : -1.0) * right;
  for (int r = 0; r < grid.rows; ++r) {
    for (int k = 0; k < grid.trees; ++k) {
      Vector2d p = r * grid.row_spacing_m * step + k * grid.tree_spacing_m * along;
      if (features.is_geographic) {
        const geometry::Geodetic place = geometry::geodetic_of(corner, p);
        p = {place.longitude_deg, place.latitude_deg};
      }
      features.trees.push_back(
          {std::to_string(grid.first_row + r), std::to_string(grid.first_tree + k), {p}});
    }
  }
  return features;
}

}  // namespace orchard::io
