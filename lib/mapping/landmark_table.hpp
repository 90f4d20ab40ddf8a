// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/point_grid.hpp"
#include "mapping/landmark_record.hpp"

namespace orchard::mapping {

/// All landmarks by index (id - 1), and the grid that finds them by their association
/// positions: the two change together, or not at all. An index is never used again, also when its
/// landmark was merged away.
class LandmarkTable {
 public:
  LandmarkTable() = default;

  /// A table of these records, each at its own index; those that are removed hold nothing.
  explicit LandmarkTable(std::vector<LandmarkRecord> records);

  /// A landmark with its association position there and nothing accumulated. Throws
  /// std::length_error when the indices are used up.
  std::int32_t add(const Eigen::Vector2d& p_map, double width_m);

  const LandmarkRecord& operator[](std::int32_t index) const {
    return records_[static_cast<std::size_t>(index)];
  }

  /// Calls change(record); the grid follows the association position.
  template <class Change>
  void change(std::int32_t index, Change&& change) {
    LandmarkRecord& r = records_[static_cast<std::size_t>(index)];
    const Eigen::Vector2d from = r.association_position();
    change(r);
    grid_.move(index, from.x(), from.y(), r.association_x_m, r.association_y_m);
  }

  /// Leaves a record that holds nothing and is_removed.
  void remove(std::int32_t index);

  /// Calls visit(index, record) for a superset of the landmarks within `radius_m` of a point.
  template <class Visit>
  void near(const Eigen::Vector2d& p_map, double radius_m, Visit&& visit) const {
    grid_.near(p_map.x(), p_map.y(), radius_m,
               [&](std::int32_t i) { visit(i, records_[static_cast<std::size_t>(i)]); });
  }

  /// One more than the largest index given out.
  std::int32_t num_indices() const { return static_cast<std::int32_t>(records_.size()); }
  std::size_t num_alive() const { return num_alive_; }
  std::size_t num_bytes() const;

  template <class Archive>
  void persist(Archive& archive) {
    archive(records_, grid_, num_alive_);
  }

 private:
  std::vector<LandmarkRecord> records_;
  geometry::PointGrid grid_;
  std::size_t num_alive_ = 0;
};

}  // namespace orchard::mapping
