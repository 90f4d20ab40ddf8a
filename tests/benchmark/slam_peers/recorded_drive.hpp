// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "detection/detection.hpp"
#include "pose/measurements.hpp"
#include "unit/pose/slam/slam_world.hpp"

namespace orchard::bench {

/// One scan of a drive: what was seen, how the wheels say that the robot moved since the scan
/// before (T_before_now), and where it truly is.
struct DriveStep {
  detection::Detections seen;
  std::vector<int> trees;  ///< the true tree of each trunk seen, -1 for a false one
  Eigen::Vector3d T_before_now = Eigen::Vector3d::Zero();
  Eigen::Vector3d T_start_base = Eigen::Vector3d::Zero();
};

/// A drive through a block of trees that every competitor gets alike.
struct RecordedDrive {
  std::vector<Eigen::Vector2d> trees;                 ///< in the frame of the first pose
  std::vector<std::vector<pose::Odometry>> odometry;  ///< that came before each step
  std::vector<DriveStep> steps;
};

/// Two rounds through a block of about `num_trees` trees. Identities are read off the geometry: a
/// trunk seen belongs to the tree within half a metre of where the true pose puts it.
RecordedDrive record_drive(std::uint64_t seed, int num_trees);

/// What a competitor is told of the sightings.
enum class Sightings {
  kUnknown,     ///< bearing and range, nobody knows of which tree
  kIdentified,  ///< bearing, range and the tree's number; false sightings left out
  kScan,        ///< a laser scan with an arc where each trunk was seen and nothing elsewhere
};

/// Writes the drive as an MRPT rawlog of action/observation pairs, one pair per scan. Throws
/// std::runtime_error when the file cannot be written.
void write_rawlog(const RecordedDrive& drive, Sightings sightings, const std::string& path);

}  // namespace orchard::bench
