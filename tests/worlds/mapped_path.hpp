// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "mapping/pose_track.hpp"
#include "pose/localiser.hpp"

namespace orchard {

/// The path as a mapper has it: it hears each pose when the next time comes, after the correction
/// that the pose already includes.
class MappedPath {
 public:
  explicit MappedPath(double gap_max_s) : track_(gap_max_s) {}

  /// Call after each measurement. Returns the correction, if there was one.
  std::optional<pose::Trajectory> hear(pose::Localiser& localiser) {
    for (const auto& past : localiser.take_past_poses()) track_.add(past);
    const auto estimate = localiser.estimate();
    if (last_ && (!estimate || estimate->utime > last_->utime)) track_.add(*last_);
    last_ = estimate;
    return correct(localiser, false);
  }

  /// Ends the drive: the last pose was told before the last correction.
  std::optional<pose::Trajectory> finish(pose::Localiser& localiser) {
    if (last_) track_.add(*last_);
    localiser.finish();
    return correct(localiser, true);
  }

  std::vector<pose::PoseEstimate> poses() const { return track_.poses(); }

 private:
  std::optional<pose::Trajectory> correct(pose::Localiser& localiser, bool is_end) {
    auto trajectory = localiser.take_correction();
    if (!trajectory) return trajectory;
    if (is_end && last_) trajectory->utime = last_->utime + 1;
    track_.correct(*trajectory);
    return trajectory;
  }

  mapping::PoseTrack track_;
  std::optional<pose::PoseEstimate> last_;
};

}  // namespace orchard
