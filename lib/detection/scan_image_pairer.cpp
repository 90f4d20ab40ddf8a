// SPDX-License-Identifier: BSD-3-Clause
#include "detection/scan_image_pairer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace orchard::detection {
namespace {

/// A camera without a laser must not fill the memory.
constexpr std::size_t kMaxImages = 64;
constexpr std::size_t kMaxMotions = 1024;
/// An older motion says nothing of now.
constexpr std::int64_t kMotionAgeMax_us = 200'000;

std::int64_t microseconds(double seconds) { return std::llround(seconds * 1e6); }

}  // namespace

ScanImagePairer::ScanImagePairer(double tolerance_s, double wait_s, bool with_motion,
                                 double delay_s)
    : tolerance_us_(microseconds(tolerance_s)),
      wait_us_(microseconds(wait_s)),
      delay_us_(microseconds(delay_s)),
      with_motion_(with_motion) {}

std::vector<ScanImagePair> ScanImagePairer::add(laser::Scan scan) {
  newest_utime_ = std::max(newest_utime_, scan.utime);
  scans_.push_back(std::move(scan));
  return release();
}

std::vector<ScanImagePair> ScanImagePairer::add(vision::Image image) {
  const std::int64_t exposure_utime = image.utime - delay_us_;
  newest_utime_ = std::max(newest_utime_, exposure_utime);
  newest_image_utime_ = std::max(newest_image_utime_, exposure_utime);
  if (timed_out_scan_utime_ != INT64_MIN &&
      exposure_utime <= timed_out_scan_utime_ + tolerance_us_) {
    ++num_late_;
  }
  const auto after = std::upper_bound(
      images_.begin(), images_.end(), exposure_utime,
      [](std::int64_t utime, const Exposed& other) { return utime < other.utime; });
  images_.insert(after, {exposure_utime, std::make_shared<const vision::Image>(std::move(image))});
  std::vector<ScanImagePair> pairs = release();
  forget_old();
  return pairs;
}

std::vector<ScanImagePair> ScanImagePairer::add(const Motion& motion) {
  if (!with_motion_) return {};
  newest_utime_ = std::max(newest_utime_, motion.utime);
  newest_motion_utime_ = std::max(newest_motion_utime_, motion.utime);
  const auto after =
      std::upper_bound(motions_.begin(), motions_.end(), motion.utime,
                       [](std::int64_t utime, const Motion& other) { return utime < other.utime; });
  motions_.insert(after, motion);
  std::vector<ScanImagePair> pairs = release();
  forget_old();
  return pairs;
}

std::vector<ScanImagePair> ScanImagePairer::flush() {
  std::vector<ScanImagePair> pairs;
  while (!scans_.empty()) pairs.push_back(pair_front(false));
  return pairs;
}

std::optional<std::int64_t> ScanImagePairer::waiting_scan_utime() const {
  if (scans_.empty()) return std::nullopt;
  return scans_.front().utime;
}

std::optional<std::int64_t> ScanImagePairer::newest_motion_utime() const {
  if (newest_motion_utime_ == INT64_MIN) return std::nullopt;
  return newest_motion_utime_;
}

std::vector<ScanImagePair> ScanImagePairer::release() {
  std::vector<ScanImagePair> pairs;
  while (!scans_.empty()) {
    const std::int64_t scan_utime = scans_.front().utime;
    const bool is_decided = decided(scan_utime);
    const bool timed_out = newest_utime_ - wait_us_ > scan_utime;
    if (!is_decided && !timed_out) break;
    pairs.push_back(pair_front(newest_image_utime_ < scan_utime));
  }
  return pairs;
}

bool ScanImagePairer::decided(std::int64_t scan_utime) const {
  if (newest_image_utime_ < scan_utime) return false;
  if (!with_motion_) return true;
  for (const Exposed& exposed : images_) {
    if (exposed.utime < scan_utime) continue;
    return !motions_.empty() && motions_.back().utime >= exposed.utime;
  }
  return true;  // the picture is forgotten already: nothing to wait for
}

std::optional<Motion> ScanImagePairer::motion_at(std::int64_t utime) const {
  std::optional<Motion> best;
  for (const Motion& motion : motions_) {  // the earlier of equals
    const std::int64_t age_us = std::llabs(motion.utime - utime);
    if (age_us > kMotionAgeMax_us) continue;
    if (!best || age_us < std::llabs(best->utime - utime)) best = motion;
  }
  return best;
}

ScanImagePair ScanImagePairer::pair_front(bool timed_out) {
  ScanImagePair pair;
  pair.scan = std::move(scans_.front());
  scans_.pop_front();
  if (timed_out) timed_out_scan_utime_ = std::max(timed_out_scan_utime_, pair.scan.utime);
  std::int64_t best_us = tolerance_us_;
  std::int64_t exposure_utime = 0;
  for (const Exposed& exposed : images_) {  // the earlier of equals
    const std::int64_t distance_us = std::llabs(exposed.utime - pair.scan.utime);
    if (distance_us < best_us || (!pair.image && distance_us == best_us)) {
      best_us = distance_us;
      pair.image = exposed.image;
      exposure_utime = exposed.utime;
    }
  }
  if (pair.image) pair.motion = motion_at(exposure_utime);
  if (pair.image && with_motion_ && !pair.motion) ++num_without_motion_;
  return pair;
}

void ScanImagePairer::forget_old() {
  // Scans may lag behind the pictures by as much as pictures may lag behind them.
  const std::int64_t oldest_scan_utime =
      scans_.empty() ? newest_utime_ : std::min(newest_utime_, scans_.front().utime);
  const std::int64_t horizon = oldest_scan_utime - wait_us_ - tolerance_us_;
  while (!images_.empty() && (images_.front().utime < horizon || images_.size() > kMaxImages)) {
    images_.pop_front();
  }
  while (!motions_.empty() &&
         (motions_.front().utime < horizon - kMotionAgeMax_us || motions_.size() > kMaxMotions)) {
    motions_.pop_front();
  }
}

}  // namespace orchard::detection
