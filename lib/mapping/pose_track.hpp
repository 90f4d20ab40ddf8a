// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "detection/detection.hpp"
#include "mapping/store/chunked_array.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Pose of base at any time, interpolated between the received poses.
///
/// x, y and the covariance are interpolated linearly, the angles along the shorter arc. Not
/// mrpt::poses::CPose3DInterpolator, because that has no covariance, which association needs.
class PoseTrack {
 public:
  /// `memory` stores the poses; the heap if null.
  explicit PoseTrack(double gap_max_s, std::shared_ptr<ChunkAllocator> memory = nullptr)
      : gap_max_us_(static_cast<std::int64_t>(gap_max_s * 1e6)),
        poses_(memory ? std::move(memory) : std::make_shared<HeapChunkAllocator>()) {}

  /// Adds a pose; ignored if a pose of the same time exists.
  void add(const pose::PoseEstimate& pose);

  /// Whether there is a pose at or after `utime`.
  bool covers(std::int64_t utime) const { return !poses_.empty() && poses_.back().utime >= utime; }

  /// Whether the last two poses at or before `utime` are at most `gap_max_us` apart, so that the
  /// motion within a scan can be interpolated. False with fewer than two poses.
  bool is_dense_at(std::int64_t utime, std::int64_t gap_max_us) const;

  /// The pose at `utime`: interpolated, or the first or last pose if that is at most 0.1 s away.
  /// None inside a gap larger than gap_max_s.
  std::optional<pose::PoseEstimate> at(std::int64_t utime) const;

  /// Corrects every pose before trajectory.utime, and its covariance: the correction is given at
  /// the trajectory's key times, interpolated between them and constant before the first and after
  /// the last. Poses from trajectory.utime on already include it. Returns the largest displacement
  /// [m].
  double correct(const pose::Trajectory& trajectory);

  std::size_t size() const { return poses_.size(); }

  /// All poses in order of utime.
  std::vector<pose::PoseEstimate> poses() const;

 private:
  std::size_t first_from(std::int64_t utime) const;

  std::int64_t gap_max_us_;
  ChunkedArray<pose::PoseEstimate> poses_;  ///< in order of utime
};

/// Time of the last object of a scan [us], i.e. of its middle beam. The scan's own utime when no
/// object has a later time.
std::int64_t last_utime_of(const detection::Detections& detections);

/// Removes the robot's motion during the sweep (deskewing): moves each object by the motion of base
/// between its own utime and the scan's, as if all were observed from `T_map_base`, the pose at the
/// scan's utime.
///
/// Without this, at 1 m/s a 75 ms scanner places objects straight ahead 37 mm too near. Objects
/// without a pose in the track at their utime are left unchanged. Planar.
detection::Detections deskewed(detection::Detections detections, const PoseTrack& track,
                               const pose::PoseEstimate& T_map_base);

}  // namespace orchard::mapping
