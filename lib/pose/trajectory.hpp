// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "pose/pose_estimate.hpp"

namespace orchard::pose {

/// The corrected past: where base was at key times, T_map_base in rising order of utime, by all
/// that is known now. Replaces every earlier revision whole. Between two key times a consumer
/// interpolates the correction of the POSE that it was told, not the poses themselves. It
/// corrects POSE before `utime`; those at and after that time were told with the correction.
struct Trajectory {
  std::int64_t utime = 0;           ///< of the newest measurement that it takes account of
  std::int32_t revision = 1;        ///< +1 per correction
  std::vector<PoseEstimate> poses;  ///< seq, pitch and roll unused

  template <class Archive>
  void persist(Archive& archive) {
    archive(utime, revision, poses);
  }
};

/// A part of a trajectory that fits one message.
struct TrajectoryPage {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::int32_t revision = 1;
  std::int32_t page = 0;  ///< 0 ... num_pages - 1
  std::int32_t num_pages = 1;
  std::vector<PoseEstimate> poses;
};

/// Poses of one page: 40 kB, within one UDP datagram.
inline constexpr std::size_t kPosesPerPage = 500;

/// The pages of a trajectory in order, seq not set; one empty page for an empty trajectory.
std::vector<TrajectoryPage> paginate(const Trajectory& trajectory,
                                     std::size_t poses_per_page = kPosesPerPage);

/// Puts pages together again. Pages come in order; a revision of which one is lost is dropped when
/// the next one begins.
class TrajectoryCollector {
 public:
  /// The whole trajectory when this page completes it.
  std::optional<Trajectory> add(const TrajectoryPage& page);

  std::int64_t num_incomplete() const { return num_incomplete_; }

  template <class Archive>
  void persist(Archive& archive) {
    archive(partial_, next_page_, num_incomplete_);
  }

 private:
  Trajectory partial_;
  std::int32_t next_page_ = 0;  ///< 0: none begun
  std::int64_t num_incomplete_ = 0;
};

}  // namespace orchard::pose
