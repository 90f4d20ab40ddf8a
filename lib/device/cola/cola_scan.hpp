// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "device/cola/cola_telegram.hpp"
#include "laser/scan.hpp"

namespace orchard::device {

/// Range limits and start angle of a family of scanners, found by the device's own name.
struct ColaModel {
  double range_min_m = 0.01;
  double range_max_m = 65.0;
  /// Angle at which a full sweep begins [1/10000 degree].
  std::int32_t start_angle = -450000;
};

/// The model for the name in a reply to DeviceIdent ("TiM561-2050101"); unknown names get the
/// widest limits.
ColaModel cola_model(std::string_view name);

/// Output angles reported by the device (LMPoutputRange) [1/10000 degree].
struct ColaRange {
  std::int32_t start = 0;
  std::int32_t stop = 0;
};

/// The name in the fields of "sRA DeviceIdent"; empty when they are malformed.
std::string_view parse_cola_name(ColaFields fields);

/// The fields of "sRA LMPoutputRange".
std::optional<ColaRange> parse_cola_range(ColaFields fields);

/// The content of one LMDscandata telegram.
struct ColaScan {
  std::uint32_t num_sent = 0;     ///< telegram counter, 16 bits
  std::uint32_t start_ticks = 0;  ///< "time since start up": us since power-up, 32 bits
  std::uint32_t sent_ticks = 0;   ///< same clock: transmission of the telegram
  double to_first_beam_us = 0.0;  ///< from the start of a full sweep to the first beam
  double to_last_beam_us = 0.0;   ///< from there to the last beam
  bool has_error = false;         ///< device status: measurement error
  bool is_dirty = false;          ///< device status: front screen is dirty
  laser::Scan scan;               ///< without utime and seq
};

/// Parses the fields of "sSN LMDscandata" (SICK telegram listing 8014631). None when they are
/// incomplete, a number is malformed, or angles, counts or rates are implausible.
///
/// Device angles count from the right, so that 90 degrees is straight ahead. The angular step is
/// rounded to 1/10000 degree; where `range` has the same first beam and about the same step, the
/// step is computed from its ends instead. RSSI1 gives the intensities when the telegram has it.
std::optional<ColaScan> parse_cola_scan(ColaFields fields, const ColaModel& model,
                                        const std::optional<ColaRange>& range);

}  // namespace orchard::device
