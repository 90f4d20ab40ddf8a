// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>

#include "pose/measurements.hpp"

namespace orchard::pose {

/// The way of base as wheels or fixes tell it, to be asked for any time in between.
class ReferencePath {
 public:
  /// A pose of base in the path's own frame. Only those of one piece have a motion between them.
  struct Place {
    Eigen::Vector3d T_path_base = Eigen::Vector3d::Zero();
    int piece = 0;
  };

  /// Adds a reading; one not later than the last is ignored, and a gap of more than a second begins
  /// a new piece.
  void add(const Odometry& odometry);
  /// Adds a fix with a heading; others are ignored.
  void add(const PoseFix& fix);

  /// The newest time [us]; none before the first reading.
  std::optional<std::int64_t> reached_utime() const;

  /// The place at a time, between two readings; none in a gap, before the first and after the last
  /// one. A fix's own time is always known.
  std::optional<Place> at(std::int64_t utime) const;

  /// Forgets what lies before a time.
  void forget_before(std::int64_t utime);

 private:
  struct Entry {
    std::int64_t utime = 0;
    Place place;
    bool follows = false;  ///< the motion from the entry before it is known
  };
  std::deque<Entry> entries_;
};

}  // namespace orchard::pose
