// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::device {

/// Parameters of a scanner (reply to PP), which determine its angles, ranges and times.
struct ScipParameters {
  std::string model;       ///< MODL, verbatim
  int range_min_mm = 0;    ///< DMIN: values below are error codes
  int range_max_mm = 0;    ///< DMAX
  int steps_per_turn = 0;  ///< ARES
  int first_step = 0;      ///< AMIN
  int last_step = 0;       ///< AMAX
  int front_step = 0;      ///< AFRT: straight ahead
  double rate_rpm = 0.0;   ///< SCAN, or the motor speed reported by II

  int num_beams() const { return last_step - first_step + 1; }

  /// Angle of one step; steps count counter-clockwise, seen from above.
  double step_rad() const { return 2.0 * geometry::kPi / steps_per_turn; }
  double bearing_min_rad() const { return (first_step - front_step) * step_rad(); }
  double turn_us() const { return 60e6 / rate_rpm; }
  double beam_period_us() const { return turn_us() / steps_per_turn; }

  /// Ranges up to 4095 mm fit two characters, larger ones need three.
  bool fits_two_characters() const { return range_max_mm <= 4095; }
};

/// Parses the lines of a reply to PP. None when a number is missing, a checksum is wrong, or the
/// values together are implausible.
std::optional<ScipParameters> parse_scip_parameters(const std::vector<std::string_view>& lines);

/// Parses the motor speed [rpm] from the lines of a reply to II ("SCSP:Initial(600[rpm])"); none
/// when absent.
std::optional<double> parse_scip_motor_rpm(const std::vector<std::string_view>& lines);

}  // namespace orchard::device
