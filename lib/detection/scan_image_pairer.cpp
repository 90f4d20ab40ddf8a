// SPDX-License-Identifier: BSD-3-Clause
#include "detection/scan_image_pairer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "timing/units.hpp"

namespace orchard::detection {
namespace {

/// Limits on stored messages, so that a camera without a laser, or scans whose partners never come,
/// cannot fill the memory.
// derived: two seconds of images at 30 Hz, of motions at 500 Hz and of scans at 100 Hz.
constexpr std::size_t kMaxImages = 64;
constexpr std::size_t kMaxMotions = 1024;
constexpr std::size_t kMaxScans = 256;

}  // namespace

ScanImagePairer::ScanImagePairer(double tolerance_s, double wait_s, bool with_motion,
                                 double delay_s)
    : tolerance_us_(timing::microseconds(tolerance_s)),
      wait_us_(timing::microseconds(wait_s)),
      delay_us_(timing::microseconds(delay_s)),
      scans_({{{std::nullopt},
               {wait_us_},
               {with_motion ? std::optional<std::int64_t>(wait_us_) : std::nullopt}}}),
      with_motion_(with_motion) {}

std::vector<ScanImagePair> ScanImagePairer::add(laser::Scan scan) {
  const std::int64_t scan_utime = scan.utime;
  scans_.push(kScan, scan_utime, std::move(scan));
  std::vector<ScanImagePair> pairs = release();
  while (scans_.size(kScan) > kMaxScans) pairs.push_back(pair_front(true));
  return pairs;
}

std::vector<ScanImagePair> ScanImagePairer::add(std::shared_ptr<const vision::Image> image) {
  const std::int64_t exposure_utime = image->utime - delay_us_;
  scans_.reach(kImage, exposure_utime);
  if (timed_out_scan_utime_ != Queue::kNever &&
      exposure_utime <= timed_out_scan_utime_ + tolerance_us_) {
    ++num_late_;
  }
  const auto after = std::upper_bound(
      images_.begin(), images_.end(), exposure_utime,
      [](std::int64_t utime, const Exposed& other) { return utime < other.utime; });
  images_.insert(after, {exposure_utime, std::move(image)});
  std::vector<ScanImagePair> pairs = release();
  forget_old();
  return pairs;
}

std::vector<ScanImagePair> ScanImagePairer::add(const Motion& motion) {
  if (!with_motion_) return {};
  scans_.reach(kMotion, motion.utime);
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
  while (!scans_.is_empty(kScan)) pairs.push_back(pair_front(false));
  return pairs;
}

std::optional<std::int64_t> ScanImagePairer::waiting_scan_utime() const {
  if (scans_.is_empty(kScan)) return std::nullopt;
  return scans_.front(kScan).utime;
}

std::vector<ScanImagePair> ScanImagePairer::release() {
  std::vector<ScanImagePair> pairs;
  while (!scans_.is_empty(kScan)) {
    const std::int64_t scan_utime = scans_.front(kScan).utime;
    const auto needed_utime = [&](std::size_t kind) {
      return kind == kMotion ? motion_needed_utime(scan_utime) : scan_utime;
    };
    if (scans_.blocker(scan_utime, needed_utime)) break;
    pairs.push_back(pair_front(scans_.reached(kImage) < scan_utime));
  }
  return pairs;
}

/// The time up to which motions are needed for a scan: the exposure of the first image at or after
/// it. kNever if that image is no longer stored.
std::int64_t ScanImagePairer::motion_needed_utime(std::int64_t scan_utime) const {
  for (const Exposed& exposed : images_) {
    if (exposed.utime >= scan_utime) return exposed.utime;
  }
  return Queue::kNever;
}

std::optional<Motion> ScanImagePairer::motion_at(std::int64_t utime) const {
  // A motion is the mean up to its end, so the first one that ends at or after the time applies;
  // if there is none, the latest one.
  const auto behind = std::find_if(motions_.begin(), motions_.end(),
                                   [&](const Motion& motion) { return motion.utime >= utime; });
  const auto is_fresh = [&](const Motion& motion) {
    return std::llabs(motion.utime - utime) <= kMotionAgeMax_us;
  };
  if (behind != motions_.end() && is_fresh(*behind)) return *behind;
  if (behind != motions_.begin() && is_fresh(*(behind - 1))) return *(behind - 1);
  return std::nullopt;
}

ScanImagePair ScanImagePairer::pair_front(bool timed_out) {
  ScanImagePair pair;
  pair.scan = scans_.take(kScan);
  if (timed_out) timed_out_scan_utime_ = std::max(timed_out_scan_utime_, pair.scan.utime);
  std::int64_t best_us = tolerance_us_;
  std::int64_t exposure_utime = 0;
  for (const Exposed& exposed : images_) {  // of two equally near images the earlier one
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
  // Of the scans to come none is earlier than the last one.
  const std::int64_t oldest_scan_utime = scans_.is_empty(kScan)
                                             ? std::max<std::int64_t>(scans_.reached(kScan), 0)
                                             : scans_.front_utime(kScan);
  const std::int64_t horizon = oldest_scan_utime - tolerance_us_;
  while (!images_.empty() && (images_.front().utime < horizon || images_.size() > kMaxImages)) {
    images_.pop_front();
  }
  while (!motions_.empty() &&
         (motions_.front().utime < horizon - kMotionAgeMax_us || motions_.size() > kMaxMotions)) {
    motions_.pop_front();
  }
}

}  // namespace orchard::detection
