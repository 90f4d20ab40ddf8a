// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "device/gnss/gpsd_report.hpp"
#include "pose/measurements.hpp"

namespace orchard::device {

/// NMEA GGA quality of a gpsd fix.
std::int8_t gga_quality(const GpsdFix& fix);

/// The name of a GGA quality for the user: "RTK fixed".
std::string quality_name(std::int8_t quality);

/// ENU covariance [m2] of a fix: ee en eu nn nu uu; all 0 when unknown. `noise`: of the same
/// moment, or null.
///
/// Uses the best source available: the receiver's error ellipse or standard deviations (GST), then
/// eph and epv, then epx, epy and epv. For an RTK solution the last two count only up to 1 m: gpsd
/// computes eph of NMEA receivers as a range error of metres times the dilution of precision, which
/// says nothing about RTK.
std::array<double, 6> enu_covariance(const GpsdFix& fix, const GpsdNoise* noise);

/// Converts a fix to a measurement with utime 0; none when it has no position.
std::optional<pose::Gnss> to_measurement(const GpsdFix& fix, const GpsdNoise* noise);

}  // namespace orchard::device
