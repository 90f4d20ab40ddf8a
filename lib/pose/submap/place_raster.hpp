// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace orchard::pose {

/// What scans say of the ground around a place: cells where returns came from count for a point
/// that falls there, cells that beams passed through count against it, the rest says nothing.
///
/// Coarser and coarser copies hold, at the same spacing, the best value of ever larger squares, by
/// which whole regions of places are ruled out at once (after Hess et al. 2016).
class PlaceRaster {
 public:
  static constexpr int kHit = 100;      ///< value of a cell on a return
  static constexpr int kThrough = -60;  ///< of one that beams passed through
  static constexpr int kLevels = 6;     ///< squares of 1 to 32 cells

  /// `kernel_m` is how far a return may lie from where it was, 1-sigma.
  PlaceRaster(const Eigen::Vector2d& centre_map, double half_side_m, double cell_m,
              double kernel_m);

  /// A beam that came back from `hit_map`.
  void add(const Eigen::Vector2d& laser_map, const Eigen::Vector2d& hit_map);

  /// After the last beam: makes the values and their coarser copies.
  void finish();

  double cell_m() const { return cell_m_; }
  int column(double x_map_m) const;
  int row(double y_map_m) const;

  /// The best value of the square of 2^level cells whose first cell that is; 0 outside.
  int best(int level, int column, int row) const {
    if (column < 0 || row < 0 || column >= side_ || row >= side_)
      return outside(level, column, row);
    return levels_[static_cast<std::size_t>(level)]
                  [static_cast<std::size_t>(row) * static_cast<std::size_t>(side_) +
                   static_cast<std::size_t>(column)];
  }

 private:
  /// A square that begins outside may reach in: nothing better is known of it than a hit.
  int outside(int level, int column, int row) const {
    const int reach = 1 << level;
    return column > -reach && row > -reach && column < side_ && row < side_ ? kHit : 0;
  }

  double cell_m_;
  double kernel_m_;
  int side_;
  Eigen::Vector2d corner_map_;
  std::vector<std::uint8_t> passed_;
  std::vector<std::vector<std::int8_t>> levels_;
};

}  // namespace orchard::pose
