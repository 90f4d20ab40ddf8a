// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace orchard::geometry {

/// Immutable points with a grid for radius searches.
class IndexedPoints {
 public:
  explicit IndexedPoints(std::vector<Eigen::Vector2d> points);

  std::size_t size() const { return points_.size(); }
  const Eigen::Vector2d& operator[](std::size_t i) const { return points_[i]; }
  const std::vector<Eigen::Vector2d>& points() const { return points_; }

  /// Index of the nearest point within `radius_m`, the lowest among equally near ones; -1 for none.
  std::int32_t nearest(const Eigen::Vector2d& p, double radius_m) const;

  /// All points within `radius_m`, in order of index.
  std::vector<std::int32_t> within(const Eigen::Vector2d& p, double radius_m) const;

  /// Up to `count` nearest points within `radius_m`, nearest first.
  std::vector<std::int32_t> nearest_few(const Eigen::Vector2d& p, double radius_m,
                                        std::size_t count) const;

  /// Calls visit(index) for all points in the cells within `radius_m` (a superset of the disc).
  template <class Visit>
  void near(const Eigen::Vector2d& p, double radius_m, Visit&& visit) const {
    visit_cells(p, radius_m, [&](std::uint32_t k) { visit(by_cell_[k]); });
  }

 private:
  std::size_t column(double x_m) const {
    return clamped((x_m - corner_.x()) * cells_per_m_, num_columns_);
  }
  std::size_t line(double y_m) const {
    return clamped((y_m - corner_.y()) * cells_per_m_, num_lines_);
  }
  /// Calls visit(k) for the places k in by_cell_ of all points in the cells within `radius_m`.
  template <class Visit>
  void visit_cells(const Eigen::Vector2d& p, double radius_m, Visit&& visit) const {
    if (points_.empty()) return;
    const std::size_t x_first = column(p.x() - radius_m), x_last = column(p.x() + radius_m);
    const std::size_t y_last = line(p.y() + radius_m);
    for (std::size_t y = line(p.y() - radius_m); y <= y_last; ++y) {
      // The cells of a line are contiguous.
      const std::uint32_t* const of_line = begins_.data() + y * num_columns_;
      const std::uint32_t end = of_line[x_last + 1];
      for (std::uint32_t k = of_line[x_first]; k < end; ++k) visit(k);
    }
  }
  static std::size_t clamped(double index, std::size_t num) {
    return index <= 0.0 ? 0
                        : static_cast<std::size_t>(std::min(index, static_cast<double>(num - 1)));
  }

  std::vector<Eigen::Vector2d> points_;
  Eigen::Vector2d corner_{0.0, 0.0};
  double cells_per_m_ = 0.5;
  std::size_t num_columns_ = 1, num_lines_ = 1;
  std::vector<std::uint32_t> begins_;            ///< start of each cell in by_cell_, and the end
  std::vector<std::int32_t> by_cell_;            ///< indices, in ascending order within a cell
  std::vector<Eigen::Vector2d> points_by_cell_;  ///< points_[by_cell_[k]]: near in memory, too
};

/// Median nearest-neighbour distance [m]; 0 for fewer than two points.
double typical_spacing_m(const IndexedPoints& points);

}  // namespace orchard::geometry
