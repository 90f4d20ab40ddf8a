// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
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

}  // namespace orchard::geometry
