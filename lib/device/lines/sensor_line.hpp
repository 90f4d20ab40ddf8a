// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace orchard::device {

/// `V speed yaw_rate [speed_sd yaw_rate_sd]`: the robot's velocity.
struct VelocityLine {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
  double speed_sd_mps = 0.0;  ///< both 0: unknown
  double yaw_rate_sd_radps = 0.0;
};

/// `T left right`: what the wheels' counters stand at.
struct TickLine {
  std::int64_t left = 0;
  std::int64_t right = 0;
};

/// `I gx gy gz ax ay az [roll pitch yaw]`: an inertial unit's sample, in its own axes.
struct InertialLine {
  std::array<double, 3> angular_rate_radps{};
  std::array<double, 3> acceleration_mps2{};
  std::array<double, 3> orientation_rad{};  ///< roll, pitch, yaw
  bool has_orientation = false;
};

/// One line of a robot's controller. The page of this folder describes the format.
struct SensorLine {
  std::variant<VelocityLine, TickLine, InertialLine> content;
  std::optional<std::int64_t> device_time_us;  ///< `@time`: by the controller's own clock
  bool has_checksum = false;
};

/// Nothing for us: a comment.
struct Comment {};

/// Why a line was refused, in words for a person.
struct BadLine {
  std::string why;
};

/// Reads a line without its end: any bytes are a line, a comment or bad.
std::variant<SensorLine, Comment, BadLine> parse_sensor_line(std::string_view line);

/// The checksum that follows `*`: all bytes before it, exclusive-or.
std::uint8_t line_checksum(std::string_view bytes);

}  // namespace orchard::device
