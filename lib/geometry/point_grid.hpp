// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace orchard::geometry {

/// Hash grid over the plane for radius searches.
///
/// Holds indices only; the caller keeps the positions. A query of radius up to half a cell visits
/// the four cells around the point; a larger one visits more. Memory: 16 bytes per table entry at a
/// load of at most 0.7, and 4 bytes per point. Unlike this grid, the scan matcher's PointMap stores
/// the points themselves in a wrapped raster of bounded memory.
class PointGrid {
 public:
  explicit PointGrid(double cell_m = 2.0) : cells_per_m_(1.0 / cell_m) {}

  void insert(std::int32_t index, double x_m, double y_m);
  void insert(std::int32_t index, const Eigen::Vector2d& p) { insert(index, p.x(), p.y()); }
  /// Removes `index`, which was inserted at this position.
  void remove(std::int32_t index, double x_m, double y_m);
  /// Updates the cell of `index` after its position changed.
  void move(std::int32_t index, double from_x_m, double from_y_m, double to_x_m, double to_y_m);

  void clear();

  /// Calls visit(index) for every index in the cells within `radius_m` of the point, a superset of
  /// the disc. The order depends only on the sequence of calls.
  template <class Visit>
  void near(double x_m, double y_m, double radius_m, Visit&& visit) const {
    if (slots_.empty()) return;
    const std::int32_t x_last = cell(x_m + radius_m);
    const std::int32_t y_last = cell(y_m + radius_m);
    for (std::int32_t cx = cell(x_m - radius_m); cx <= x_last; ++cx) {
      for (std::int32_t cy = cell(y_m - radius_m); cy <= y_last; ++cy) {
        const Slot& slot = slots_[find(key(cx, cy))];
        for (std::int32_t i = slot.head; i >= 0; i = next_[static_cast<std::size_t>(i)]) visit(i);
      }
    }
  }

  /// The same, in ascending order of index.
  std::vector<std::int32_t> near(const Eigen::Vector2d& p, double radius_m) const;

  std::size_t num_bytes() const {
    return slots_.capacity() * sizeof(Slot) + next_.capacity() * sizeof(std::int32_t);
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::int32_t head = kEmpty;  ///< kEmpty: never used; kNone: used earlier, now without points
  };
  // derived: below any index.
  static constexpr std::int32_t kNone = -1;
  static constexpr std::int32_t kEmpty = -2;

  std::int32_t cell(double coordinate_m) const {
    // Positions are checked on entry; the clamp keeps the cast defined for any value.
    const double index = std::floor(coordinate_m * cells_per_m_);
    return static_cast<std::int32_t>(index < -1e9 ? -1e9 : index > 1e9 ? 1e9 : index);
  }
  static std::uint64_t key(std::int32_t cx, std::int32_t cy) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(cx)) << 32) |
           static_cast<std::uint32_t>(cy);
  }
  std::size_t find(std::uint64_t wanted) const;
  void grow();

  double cells_per_m_;
  std::vector<Slot> slots_;  ///< open addressing, size a power of two
  std::vector<std::int32_t> next_;
  std::size_t num_used_ = 0;
};

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
