// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "detection/motion.hpp"
#include "laser/scan.hpp"
#include "timing/ordered_queue.hpp"
#include "vision/image.hpp"

namespace orchard::detection {

/// A scan with the picture nearest to it in time, or without one.
struct ScanImagePair {
  laser::Scan scan;
  std::shared_ptr<const vision::Image> image;  ///< null when none was near enough
  std::optional<Motion> motion;  ///< at its exposure, when motions are given and known
};

/// Gives each scan the nearest picture within a tolerance, in order of the scans. The time of a
/// picture is that of its exposure, a fixed delay before its utime.
///
/// A scan is decided when a picture at or after it has come (and, with motions, a motion at or
/// after that picture), or when a message later by more than the wait has. So the pairs do not
/// depend on the order in which the channels arrive as long as none is delayed by more than the
/// wait. Time is the messages' own. A channel whose time falls by more than a minute had its clock
/// set back: its earlier messages are done with. What is kept is bounded.
class ScanImagePairer {
 public:
  /// `with_motion`: pairs wait for motions too. `delay_s`: camera.delay_s.
  ScanImagePairer(double tolerance_s, double wait_s, bool with_motion = false,
                  double delay_s = 0.0);

  /// Takes a scan; gives the pairs that are decided now.
  std::vector<ScanImagePair> add(laser::Scan scan);
  /// Takes a picture; gives the pairs that are decided now.
  std::vector<ScanImagePair> add(vision::Image image);
  /// Takes a motion; gives the pairs that are decided now.
  std::vector<ScanImagePair> add(const Motion& motion);
  /// Decides all that wait.
  std::vector<ScanImagePair> flush();

  /// Pictures that came after the scan they belong to was decided without them.
  std::int64_t num_late() const { return num_late_; }
  /// Pairs that were decided with a picture, but without the motion they waited for.
  std::int64_t num_without_motion() const { return num_without_motion_; }
  /// The newest motion that has come, or none.
  std::optional<std::int64_t> newest_motion_utime() const;
  /// The scan that waits longest, or none.
  std::optional<std::int64_t> waiting_scan_utime() const;

 private:
  struct Exposed {
    std::int64_t utime;  ///< of the exposure
    std::shared_ptr<const vision::Image> image;
  };

  enum Kind : std::size_t { kScan, kImage, kMotion, kNumKinds };
  using Queue = timing::OrderedQueue<laser::Scan, kNumKinds>;  // of images and motions: their times

  std::vector<ScanImagePair> release();
  ScanImagePair pair_front(bool timed_out);
  std::int64_t motion_needed_utime(std::int64_t scan_utime) const;
  std::optional<Motion> motion_at(std::int64_t utime) const;
  void forget_old();

  std::int64_t tolerance_us_;
  std::int64_t wait_us_;
  std::int64_t delay_us_;
  Queue scans_;                                     ///< waiting, in order of arrival
  std::int64_t newest_scan_utime_ = Queue::kNever;  ///< of those that have come
  std::deque<Exposed> images_;                      ///< kept, in order of exposure
  std::int64_t timed_out_scan_utime_ =
      Queue::kNever;  ///< newest scan decided without waiting longer
  std::int64_t num_late_ = 0;
  std::int64_t num_without_motion_ = 0;
  bool with_motion_;
  std::deque<Motion> motions_;  ///< kept, in order of utime
};

}  // namespace orchard::detection
