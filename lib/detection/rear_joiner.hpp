// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "detection/detection.hpp"
#include "detection/motion.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "timing/ordered_queue.hpp"

namespace orchard::detection {

/// Merges the detections of two scanners into one message, so that landmarks are associated in one
/// view of the robot's whole surroundings.
///
/// A sweep of the second scanner belongs to the sweep of the first one during whose turn it began.
/// Each object keeps its own time. Of an object that both detected, the detection judged by a
/// camera is kept, otherwise the more certain one; the motion between the two is compensated by
/// ODOMETRY. A view is released when the second scanner and ODOMETRY have reached its time, or when
/// message time is more than the wait ahead.
class RearJoiner {
 public:
  /// `mount`: extrinsics of the first scanner; range and bearing of all objects are in its frame.
  /// `wait_s`: max wait for the second scanner in message time; with `with_motion` also the wait
  /// for ODOMETRY.
  RearJoiner(const laser::LaserConfig& mount, double wait_s, bool with_motion = false);

  /// Adds detections of the first scanner; `turn_us`: period of its rotation. Returns the views
  /// that are complete now.
  std::vector<Detections> add_front(Detections detections, std::int64_t turn_us);
  /// Adds detections of the second scanner. Returns the views that are complete now.
  std::vector<Detections> add_rear(Detections detections);
  /// Adds a motion of base. Returns the views that are complete now.
  std::vector<Detections> add(const Motion& motion);
  /// Releases all waiting views.
  std::vector<Detections> flush();

  /// Time of the first waiting view, if any.
  std::optional<std::int64_t> waiting_utime() const;

 private:
  enum Kind : std::size_t { kFront, kRear, kMotion, kNumKinds };
  struct Half {
    Detections detections;
    std::int64_t turn_us = 0;
  };
  using Queue = timing::OrderedQueue<Half, kNumKinds>;

  std::vector<Detections> release(bool flushing);
  Detections decide_front();
  std::optional<Motion> motion_at(std::int64_t utime) const;

  laser::LaserConfig mount_;
  Queue queue_;
  std::deque<Motion> motions_;  ///< in order of utime
};

/// Rotation period of a scanner [us], from the time between its beams. 0.1 s, the period of the
/// slowest scanner in use, if that is unknown.
std::int64_t turn_us(const laser::Scan& scan);

}  // namespace orchard::detection
