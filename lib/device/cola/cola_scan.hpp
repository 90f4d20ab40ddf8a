// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "laser/scan.hpp"

namespace orchard::device {

/// What a family of scanners measures with, by the name that the device gives itself.
struct ColaModel {
  double range_min_m = 0.01;
  double range_max_m = 65.0;
  /// Where a full sweep begins [1/10000 degree]: the instant that the device stamps.
  std::int32_t stamped_angle = -450000;
};

/// The model by a reply to DeviceIdent ("TiM561-2050101"); what is unknown has the widest limits.
ColaModel cola_model(std::string_view name);

/// The angles that the device says it puts out (LMPoutputRange) [1/10000 degree].
struct ColaRange {
  std::int32_t start = 0;
  std::int32_t stop = 0;
};

std::optional<ColaRange> parse_cola_range(std::string_view telegram);

/// One sweep as LMDscandata carries it.
struct ColaScan {
  std::uint32_t num_sent = 0;     ///< telegram counter, 16 bits
  std::uint32_t start_ticks = 0;  ///< us since the device started, 32 bits: full sweep begun
  std::uint32_t sent_ticks = 0;   ///< the same clock: telegram sent
  double to_first_beam_us = 0.0;  ///< from start_ticks
  bool has_error = false;         ///< the device says that it does not measure well
  bool is_dirty = false;          ///< it says that its front screen is
  laser::Scan scan;               ///< without utime and seq
};

/// Reads a telegram "sSN LMDscandata ..." (SICK telegram listing 8014631). None when it is not
/// whole, a number is none, or angles, counts or rates are those of no scanner.
///
/// Its angles count from the right; ahead is 90 degrees. The angular step is rounded to 1/10000
/// degree: where `range` says the same, its two ends give the step without that. RSSI1 becomes the
/// intensities when it comes with the ranges.
std::optional<ColaScan> parse_cola_scan(std::string_view telegram, const ColaModel& model,
                                        const std::optional<ColaRange>& range);

}  // namespace orchard::device
