// SPDX-License-Identifier: BSD-3-Clause
#include "pose/pose_estimate.hpp"

#include <algorithm>
#include <utility>

#include "timing/drive_time.hpp"

namespace orchard::pose {

std::vector<TrajectoryPage> paginate(const Trajectory& trajectory, std::size_t poses_per_page) {
  const std::size_t num_poses = trajectory.poses.size();
  const std::size_t num_pages =
      std::max<std::size_t>(1, (num_poses + poses_per_page - 1) / poses_per_page);
  std::vector<TrajectoryPage> pages(num_pages);
  for (std::size_t i = 0; i < num_pages; ++i) {
    pages[i].utime = trajectory.utime;
    pages[i].revision = trajectory.revision;
    pages[i].page = static_cast<std::int32_t>(i);
    pages[i].num_pages = static_cast<std::int32_t>(num_pages);
    const std::size_t begin = i * poses_per_page;
    const std::size_t end = std::min(num_poses, begin + poses_per_page);
    pages[i].poses.assign(trajectory.poses.begin() + static_cast<std::ptrdiff_t>(begin),
                          trajectory.poses.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return pages;
}

namespace {

/// Times ascend up to that of the trajectory, so they are of an earlier epoch before each place
/// where they fall. Poses of before the first epoch that this process knows are left out.
void put_in_epochs(Trajectory& trajectory) {
  std::vector<PoseEstimate>& poses = trajectory.poses;
  std::int64_t after = trajectory.utime + 1;
  auto first = poses.end();
  for (; first != poses.begin(); --first) {
    std::int64_t& utime = (first - 1)->utime;
    while (utime >= after) utime -= timing::kEpoch_us;
    if (utime < 0) break;
    after = utime;
  }
  poses.erase(poses.begin(), first);
}

}  // namespace

std::optional<Trajectory> TrajectoryCollector::add(const TrajectoryPage& page) {
  const bool goes_on =
      next_page_ > 0 && page.revision == partial_.revision && page.page == next_page_;
  if (!goes_on) {
    // Count an incomplete revision once: where it breaks off, or at its last page if its first is
    // missing.
    const bool broke_off = next_page_ > 0;
    if (broke_off || (page.page != 0 && page.page + 1 == page.num_pages)) ++num_incomplete_;
    next_page_ = 0;
    partial_ = {page.utime, page.revision, {}};
    if (page.page != 0) return std::nullopt;
  }
  partial_.poses.insert(partial_.poses.end(), page.poses.begin(), page.poses.end());
  next_page_ = page.page + 1;
  if (next_page_ < page.num_pages) return std::nullopt;
  next_page_ = 0;
  put_in_epochs(partial_);
  return std::exchange(partial_, {});
}

}  // namespace orchard::pose
