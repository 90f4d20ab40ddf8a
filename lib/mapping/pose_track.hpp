// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "mapping/store/cold_array.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/trajectory.hpp"

namespace orchard::mapping {

/// Where base was, at any time between the poses received.
///
/// x and y go on a straight line, the angles the short way round, the covariance linearly. Not
/// mrpt::poses::CPose3DInterpolator, which carries no covariance, and association needs it.
class PoseTrack {
 public:
  /// `memory` holds the poses; none: the heap.
  explicit PoseTrack(double gap_max_s, std::shared_ptr<ChunkMemory> memory = nullptr)
      : gap_max_us_(static_cast<std::int64_t>(gap_max_s * 1e6)),
        poses_(memory ? std::move(memory) : std::make_shared<HeapMemory>()) {}

  /// Takes a pose; one of a time already known replaces nothing and is left out.
  void add(const pose::PoseEstimate& pose);

  /// Whether a pose at or after that time is there.
  bool covers(std::int64_t utime) const { return !poses_.empty() && poses_.back().utime >= utime; }

  /// Whether the last two poses at or before that time lie no farther apart than this, so that
  /// the motion within a scan can be told from them. False before there are two.
  bool is_dense_at(std::int64_t utime, std::int64_t gap_max_us) const;

  /// The pose at that time: interpolated, or the first or last one when that is at most 0.1 s away.
  /// None inside a gap larger than the largest.
  std::optional<pose::PoseEstimate> at(std::int64_t utime) const;

  /// Corrects every pose before trajectory.utime: by what the trajectory says of its key times,
  /// interpolated between them, and as at the first and the last of them beyond; their covariances
  /// likewise. Poses from that time on were told with the correction. The farthest that base has
  /// moved [m].
  double correct(const pose::Trajectory& trajectory);

  /// All of them, in order of utime.
  std::vector<pose::PoseEstimate> poses() const;

  void persist(StateArchive& archive) { archive(poses_); }

 private:
  std::size_t first_from(std::int64_t utime) const;

  std::int64_t gap_max_us_;
  ColdArray<pose::PoseEstimate> poses_;  ///< in order of utime
};

}  // namespace orchard::mapping
