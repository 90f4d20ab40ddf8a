// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "benchmark/slam_peers/recorded_drive.hpp"

namespace orchard::bench {

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
