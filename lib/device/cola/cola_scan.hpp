// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "laser/scan.hpp"

namespace orchard::device {

/// Range limits and start angle of a family of scanners, found by the device's own name.
struct ColaModel {
  double range_min_m = 0.01;
  double range_max_m = 65.0;
  /// Angle at which a full sweep begins [1/10000 degree]: the device's time stamp is of this
  /// instant.
  std::int32_t stamped_angle = -450000;
};

/// The model for the name in a reply to DeviceIdent ("TiM561-2050101"); unknown names get the
/// widest limits.
ColaModel cola_model(std::string_view name);

/// Output angles reported by the device (LMPoutputRange) [1/10000 degree].
struct ColaRange {
  std::int32_t start = 0;
  std::int32_t stop = 0;
};

std::optional<ColaRange> parse_cola_range(std::string_view telegram);

/// The content of one LMDscandata telegram.
struct ColaScan {
  std::uint32_t num_sent = 0;     ///< telegram counter, 16 bits
  std::uint32_t start_ticks = 0;  ///< us since power-up, 32 bits: start of the full sweep
  std::uint32_t sent_ticks = 0;   ///< same clock: transmission of the telegram
  double to_first_beam_us = 0.0;  ///< time from start_ticks to the first beam
  bool has_error = false;         ///< device status: measurement error
  bool is_dirty = false;          ///< device status: front screen is dirty
  laser::Scan scan;               ///< without utime and seq
};

/// Parses a telegram "sSN LMDscandata ..." (SICK telegram listing 8014631). None when it is
/// incomplete, a number is malformed, or angles, counts or rates are implausible.
///
/// Device angles count from the right, so that 90 degrees is straight ahead. The angular step is
/// rounded to 1/10000 degree; where `range` gives the same ends, the step is computed from the ends
/// instead. RSSI1 gives the intensities when the telegram has it.
std::optional<ColaScan> parse_cola_scan(std::string_view telegram, const ColaModel& model,
                                        const std::optional<ColaRange>& range);

}  // namespace orchard::device
