// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "bus/messages/message.hpp"
#include "io/config/config.hpp"
#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/world.hpp"

namespace orchard::test {

/// How the camera's time relates to the laser's.
struct CameraTiming {
  double exposure_s = 0.0375;  ///< from a scan's first beam to the exposure of its picture
  double stamp_delay_s = 0.0;  ///< its utime is this much later than the exposure
};

/// Messages of a run through one orchard, and the truth about it.
struct RobotRun {
  std::vector<bus::Message> messages;  ///< in order of utime
  std::vector<simulation::TruthObject> truth;
  std::function<simulation::Pose2(std::int64_t utime)> pose_at;
};

/// Driving between two rows of a seed's orchard at 1 m/s, turning at 0.5 rad/s to one side and the
/// other in turn; laser swept beam by beam while it moves.
RobotRun drive(std::uint64_t seed, const io::Config& config, const CameraTiming& timing);

/// The same places, each with a scan and a picture of a standing robot.
RobotRun stop_and_go(std::uint64_t seed, const io::Config& config);

}  // namespace orchard::test
