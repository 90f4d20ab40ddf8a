// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "bus/messages/message.hpp"
#include "orchard/adaptation_t.hpp"
#include "orchard/detections_t.hpp"
#include "orchard/detections_v2_t.hpp"
#include "orchard/gnss_t.hpp"
#include "orchard/image_t.hpp"
#include "orchard/imu_t.hpp"
#include "orchard/map_tile_t.hpp"
#include "orchard/odometry_t.hpp"
#include "orchard/pose_fix_t.hpp"
#include "orchard/pose_t.hpp"
#include "orchard/scan_t.hpp"
#include "orchard/trajectory_t.hpp"

namespace orchard::bus {

// Field by field between the rooms' structs and the generated LCM types, both ways. from_wire
// trusts nothing but copies everything: check_content decides afterwards.

scan_t to_wire(const laser::Scan& scan);
image_t to_wire(const vision::Image& image);
odometry_t to_wire(const pose::Odometry& odometry);
gnss_t to_wire(const pose::Gnss& gnss);
pose_fix_t to_wire(const pose::PoseFix& fix);
pose_t to_wire(const pose::PoseEstimate& pose);
detections_v2_t to_wire(const detection::Detections& detections);
map_tile_t to_wire(const mapping::MapTile& tile);
adaptation_t to_wire(const detection::AdaptationStep& step);
imu_t to_wire(const pose::Imu& imu);
trajectory_t to_wire(const pose::TrajectoryPage& page);

laser::Scan from_wire(scan_t&& wire);
vision::Image from_wire(image_t&& wire);
pose::Odometry from_wire(odometry_t&& wire);
pose::Gnss from_wire(gnss_t&& wire);
/// Throws std::range_error for a has_yaw that is neither 0 nor 1.
pose::PoseFix from_wire(pose_fix_t&& wire);
pose::PoseEstimate from_wire(pose_t&& wire);
detection::Detections from_wire(detections_v2_t&& wire);
/// The first release's form: its probabilities are unknown.
detection::Detections from_wire(detections_t&& wire);
mapping::MapTile from_wire(map_tile_t&& wire);
detection::AdaptationStep from_wire(adaptation_t&& wire);
/// Throws std::range_error for a has_orientation that is neither 0 nor 1.
pose::Imu from_wire(imu_t&& wire);
pose::TrajectoryPage from_wire(trajectory_t&& wire);

/// The bytes of any generated type.
template <class Wire>
std::vector<std::uint8_t> encode_wire(const Wire& wire) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  if (wire.encode(bytes.data(), 0, static_cast<int>(bytes.size())) < 0) {
    throw std::logic_error("a generated LCM type did not encode into its own size");
  }
  return bytes;
}

}  // namespace orchard::bus
