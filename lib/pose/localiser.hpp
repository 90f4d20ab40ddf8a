// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "laser/laser_config.hpp"
#include "pose/graph/record_store.hpp"
#include "pose/measurements.hpp"
#include "pose/pose_config.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/prior_map/prior_map.hpp"
#include "text/finding.hpp"

namespace orchard::pose {

/// Interface of all localisation modes: estimates T_map_base from measurements in order of time.
/// There is one implementation per pose.mode. The estimate is a pure function of the configuration
/// and the sequence of add() calls; kinds of measurement that a mode does not use are ignored.
class Localiser {
 public:
  virtual ~Localiser() = default;

  virtual void add(const Measurement& measurement) = 0;

  /// Returns the pose at the time of the last measurement that moved or corrected it; none while
  /// the pose is unknown. All numbers are finite.
  virtual std::optional<PoseEstimate> estimate() const = 0;

  /// Returns, once, the poses from the time before the pose became known, in order of time. All are
  /// earlier than estimate().
  virtual std::vector<PoseEstimate> take_past_poses() { return {}; }

  /// Returns the corrected trajectory if the past was corrected since the last call, else none.
  virtual std::optional<Trajectory> take_correction() { return std::nullopt; }

  /// Ends the input. The localiser may then compute its final, best correction.
  virtual void finish() {}

  /// Describes the present problem to the user (LOST, AMBIGUOUS, GNSS jumps); empty if none.
  virtual std::string warning() const { return {}; }

  /// What is doubtful about the path of the whole drive, the worst first; none before finish().
  virtual std::vector<Finding> findings() const { return {}; }

  /// Returns named statistics of the drive so far, for the evaluation afterwards.
  virtual std::vector<std::pair<std::string, std::int64_t>> statistics() const { return {}; }
};

/// Creates the localiser of `config.mode`. Mode prior_map needs the map in `earlier`, which the
/// caller has read; throws std::invalid_argument if its landmarks cannot determine a pose. Modes
/// that use scans need the laser's extrinsics and the blind sector, in which it sees the robot
/// itself. `memory` stores old observations of a long drive (null: the heap) and does not affect
/// the results.
std::unique_ptr<Localiser> make_localiser(const PoseConfig& config,
                                          const PriorMapData& earlier = {},
                                          const laser::LaserConfig& laser = {},
                                          const laser::BlindSector& blind = {},
                                          std::shared_ptr<ChunkAllocator> memory = nullptr);

}  // namespace orchard::pose
