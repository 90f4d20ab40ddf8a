// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pose/measurement.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/trajectory.hpp"

namespace orchard::pose {

/// Turns measurements, in order of time, into T_map_base: one of these per pose.mode. A pure
/// function of its configuration and the sequence of add() calls; kinds that it does not use are
/// ignored.
class Localiser {
 public:
  virtual ~Localiser() = default;

  virtual void add(const Measurement& measurement) = 0;

  /// The pose at the time of the last measurement that moved or corrected it; none while it is
  /// unknown. Every number in it is finite.
  virtual std::optional<PoseEstimate> estimate() const = 0;

  /// Where base was before the pose became known, in order of time, once; all before estimate().
  virtual std::vector<PoseEstimate> take_past() { return {}; }

  /// A new revision of the whole past, once, when it was corrected since the last call.
  virtual std::optional<Trajectory> take_correction() { return std::nullopt; }

  /// No measurement will follow: the last and best correction may be made.
  virtual void finish() {}

  /// What is wrong in words for a person (LOST, AMBIGUOUS, a GNSS that jumps); empty if nothing.
  virtual std::string warning() const { return {}; }

  /// What it did so far in named numbers, for people and programs that judge a drive afterwards.
  virtual std::vector<std::pair<std::string, std::int64_t>> account() const { return {}; }
};

}  // namespace orchard::pose
