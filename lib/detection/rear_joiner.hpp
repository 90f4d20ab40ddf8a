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

/// Joins what a second scanner found to what the first found, so that one message shows all that
/// stands around the robot: landmarks are then looked for in one view, not in two halves of it.
///
/// A sweep of the second scanner belongs to the first scanner's sweep during whose turn it began.
/// Each object keeps its own time. What both saw counts once: the one that a camera judged, or else
/// the one that is known better; what the robot drove between the two is undone by its wheels. A
/// view is decided when the second scanner and the wheels have been heard at or after its time, or
/// when message time is more than the wait ahead.
class RearJoiner {
 public:
  /// `mount`: of the first scanner, in whose frame range and bearing of all objects are given.
  /// `wait_s`: how long a view waits for the second scanner [s of message time], and as long for
  /// the wheels with `with_motion`.
  RearJoiner(const laser::LaserConfig& mount, double wait_s, bool with_motion = false);

  /// Takes what the first scanner found; `turn_us`: how long one of its turns takes. Gives the
  /// views that are decided now.
  std::vector<Detections> add_front(Detections detections, std::int64_t turn_us);
  /// Takes what the second scanner found; gives the views that are decided now.
  std::vector<Detections> add_rear(Detections detections);
  /// Takes how base moves; gives the views that are decided now.
  std::vector<Detections> add(const Motion& motion);
  /// Decides all that wait.
  std::vector<Detections> flush();

  /// The view that waits longest, or none.
  std::optional<std::int64_t> waiting_utime() const;
  /// Views that were decided without the second scanner.
  std::int64_t num_without_rear() const { return num_without_rear_; }

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
  std::int64_t num_without_rear_ = 0;
};

/// How long a turn of a scanner takes, by the time between its beams; a tenth of a second, that of
/// the slowest in use, when it does not say [us].
std::int64_t turn_us(const laser::Scan& scan);

}  // namespace orchard::detection
