// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/look_queue.hpp"

#include <algorithm>

namespace orchard::procs {
namespace {

/// However far SCAN runs ahead of DETECTIONS (or none of these come): four minutes, a megabyte.
constexpr std::size_t kLooksMost = 1000;

std::int64_t microseconds(double duration_s) { return static_cast<std::int64_t>(1e6 * duration_s); }

}  // namespace

LookQueue::LookQueue(const io::Config& config)
    : laser_(config.laser),
      blind_(config.detector.segmentation.blind_sector()),
      period_us_(microseconds(config.mapper.existence.period_s)),
      wait_us_(config.mapper.existence.enabled ? microseconds(config.mapper.existence.scan_wait_s)
                                               : 0) {}

void LookQueue::add(const laser::Scan& scan) {
  is_missing_ = false;
  newest_utime_ = has_any_ ? std::max(newest_utime_, scan.utime) : scan.utime;
  // An earlier one than the last comes of a clock that was set back: a look like any other.
  const std::int64_t since_us = scan.utime - last_kept_utime_;
  if (has_any_ && since_us >= 0 && since_us < period_us_) return;
  has_any_ = true;
  last_kept_utime_ = scan.utime;
  auto look = std::make_shared<mapping::BeamLook>(scan, laser_, blind_);
  const auto at = std::upper_bound(
      looks_.begin(), looks_.end(), scan.utime,
      [](std::int64_t utime, const auto& other) { return utime < other->utime(); });
  looks_.insert(at, std::move(look));
  if (looks_.size() > kLooksMost) looks_.pop_front();
}

bool LookQueue::is_ready(std::int64_t utime, std::int64_t newest_utime) const {
  return !wanted() || is_missing_ || (has_any_ && newest_utime_ >= utime) ||
         newest_utime - utime > wait_us_;
}

std::shared_ptr<mapping::BeamLook> LookQueue::take(std::int64_t utime) {
  if (!wanted()) return nullptr;
  if (!has_any_ || newest_utime_ < utime) is_missing_ = true;
  while (!looks_.empty() && looks_.front()->utime() < utime) looks_.pop_front();
  if (looks_.empty() || looks_.front()->utime() != utime) return nullptr;
  auto look = std::move(looks_.front());
  looks_.pop_front();
  return look;
}

}  // namespace orchard::procs
