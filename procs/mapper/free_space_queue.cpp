// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/free_space_queue.hpp"

#include <algorithm>

namespace orchard::procs {
namespace {

/// However far SCAN runs ahead of DETECTIONS (or none of these come): four minutes, a megabyte.
constexpr std::size_t kWaitingMax = 1000;

std::int64_t microseconds(double duration_s) { return static_cast<std::int64_t>(1e6 * duration_s); }

}  // namespace

FreeSpaceQueue::FreeSpaceQueue(const io::Config& config)
    : laser_(config.laser),
      blind_(config.detector.segmentation.blind_sector()),
      presence_(config.mapper.presence),
      period_us_(microseconds(config.mapper.presence.period_s)),
      wait_us_(config.mapper.presence.enabled ? microseconds(config.mapper.presence.scan_wait_s)
                                              : 0) {}

void FreeSpaceQueue::add(const laser::Scan& scan) {
  is_missing_ = false;
  newest_utime_ = has_any_ ? std::max(newest_utime_, scan.utime) : scan.utime;
  // An earlier one than the last comes of a clock that was set back: kept like any other.
  const std::int64_t since_us = scan.utime - last_kept_utime_;
  if (has_any_ && since_us >= 0 && since_us < period_us_) return;
  has_any_ = true;
  last_kept_utime_ = scan.utime;
  auto free_space = std::make_shared<mapping::FreeSpace>(scan, laser_, blind_, presence_);
  const auto at = std::upper_bound(
      waiting_.begin(), waiting_.end(), scan.utime,
      [](std::int64_t utime, const auto& other) { return utime < other->utime(); });
  waiting_.insert(at, std::move(free_space));
  if (waiting_.size() > kWaitingMax) waiting_.pop_front();
}

bool FreeSpaceQueue::is_ready(std::int64_t utime, std::int64_t newest_utime) const {
  return !wanted() || is_missing_ || (has_any_ && newest_utime_ >= utime) ||
         newest_utime - utime > wait_us_;
}

std::shared_ptr<mapping::FreeSpace> FreeSpaceQueue::take(std::int64_t utime) {
  if (!wanted()) return nullptr;
  if (!has_any_ || newest_utime_ < utime) is_missing_ = true;
  while (!waiting_.empty() && waiting_.front()->utime() < utime) waiting_.pop_front();
  if (waiting_.empty() || waiting_.front()->utime() != utime) return nullptr;
  auto free_space = std::move(waiting_.front());
  waiting_.pop_front();
  return free_space;
}

}  // namespace orchard::procs
