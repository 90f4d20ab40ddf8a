// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace orchard::ros {

/// The definition of a ROS 2 type ("sensor_msgs/msg/LaserScan") and of those within it, as text in
/// the form that MCAP stores ("ros2msg"). Throws std::out_of_range for a type without one here.
std::string definition_of(const std::string& type);

/// Serialises a ROS 2 message by its definition: CDR, little-endian (OMG DDSI-RTPS 2.3, 10).
///
/// A field that `fields` lacks is zero or empty; bytes are given as binary or array. Throws
/// std::invalid_argument for a field that the type does not have.
std::string cdr_message(const std::string& type, const nlohmann::json& fields);

}  // namespace orchard::ros
