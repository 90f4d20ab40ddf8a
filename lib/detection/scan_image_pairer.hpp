// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "detection/motion.hpp"
#include "laser/scan.hpp"
#include "timing/ordered_queue.hpp"
#include "vision/image.hpp"

namespace orchard::detection {

/// A scan with the image nearest in time, if any.
struct ScanImagePair {
  laser::Scan scan;
  std::shared_ptr<const vision::Image> image;  ///< null if none is within the tolerance
  std::optional<Motion> motion;  ///< at the exposure; none if motions are not used or not known
};

/// Pairs each scan with the nearest image within a tolerance, in order of the scans. The time of an
/// image is its exposure, a fixed delay before its utime.
///
/// A scan is released when an image at or after it has arrived (and, with motions, a motion at or
/// after that image), or when any message is later by more than the wait. The pairs are therefore
/// independent of the order of the channels, as long as none is delayed by more than the wait. Time
/// is message time. The number of stored messages is bounded.
class ScanImagePairer {
 public:
  /// `with_motion`: pairs wait for motions, too. `delay_s`: camera.delay_s.
  ScanImagePairer(double tolerance_s, double wait_s, bool with_motion = false,
                  double delay_s = 0.0);

  /// Adds a scan. Returns the pairs that are complete now.
  std::vector<ScanImagePair> add(laser::Scan scan);
  /// Adds an image, never null. Returns the pairs that are complete now.
  std::vector<ScanImagePair> add(std::shared_ptr<const vision::Image> image);
  std::vector<ScanImagePair> add(vision::Image image) {
    return add(std::make_shared<const vision::Image>(std::move(image)));
  }
  /// Adds a motion. Returns the pairs that are complete now.
  std::vector<ScanImagePair> add(const Motion& motion);
  /// Releases all waiting scans.
  std::vector<ScanImagePair> flush();

  /// Number of images that arrived after their scan was released without them.
  std::int64_t num_late() const { return num_late_; }
  /// Number of pairs released with an image, but without the motion they waited for.
  std::int64_t num_without_motion() const { return num_without_motion_; }
  /// Time of the first waiting scan, if any.
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
  Queue scans_;                 ///< waiting, in order of utime
  std::deque<Exposed> images_;  ///< kept, in order of exposure
  /// Time of the newest scan released by timeout, before an image at or after it had arrived.
  std::int64_t timed_out_scan_utime_ = Queue::kNever;
  std::int64_t num_late_ = 0;
  std::int64_t num_without_motion_ = 0;
  bool with_motion_;
  std::deque<Motion> motions_;  ///< kept, in order of utime
};

}  // namespace orchard::detection
