// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_grid.hpp"
#include "mapping/landmark_record.hpp"

namespace orchard::mapping {

/// All landmarks by index (id - 1), with a spatial grid over their association positions. Every
/// change updates both. Indices are never reused, even after a landmark was merged away.
class LandmarkTable {
 public:
  LandmarkTable() = default;

  /// Builds a table in which records[i] has index i; removed records are empty slots.
  explicit LandmarkTable(std::vector<LandmarkRecord> records);

  /// Adds a landmark with the given association position and no observations; returns its index.
  /// Throws std::length_error when no indices are left.
  std::int32_t add(const Eigen::Vector2d& p_map, double width_m);

  const LandmarkRecord& operator[](std::int32_t index) const {
    return records_[static_cast<std::size_t>(index)];
  }

  /// Calls change(record) and updates the grid with the new association position.
  template <class Change>
  void change(std::int32_t index, Change&& change) {
    LandmarkRecord& r = records_[static_cast<std::size_t>(index)];
    const Eigen::Vector2d from = r.association_position();
    change(r);
    grid_.move(index, from.x(), from.y(), r.association_x_m, r.association_y_m);
  }

  /// Replaces the record by an empty one with is_removed set.
  void remove(std::int32_t index);

  /// Calls visit(index, record) for a superset of the landmarks within `radius_m` of a point.
  template <class Visit>
  void near(const Eigen::Vector2d& p_map, double radius_m, Visit&& visit) const {
    grid_.near(p_map.x(), p_map.y(), radius_m,
               [&](std::int32_t i) { visit(i, records_[static_cast<std::size_t>(i)]); });
  }

  /// Largest index ever used plus one.
  std::int32_t num_indices() const { return static_cast<std::int32_t>(records_.size()); }
  std::size_t num_alive() const { return num_alive_; }
  std::size_t num_bytes() const;

 private:
  std::vector<LandmarkRecord> records_;
  geometry::PointGrid grid_;
  std::size_t num_alive_ = 0;
};

}  // namespace orchard::mapping
