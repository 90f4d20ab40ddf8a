// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "device/gnss/gpsd_report.hpp"
#include "pose/measurements.hpp"

namespace orchard::device {

/// NMEA's GGA quality of a fix as gpsd states it.
std::int8_t gga_quality(const GpsdFix& fix);

/// The name of a GGA quality, for a person: "RTK fixed".
std::string quality_name(std::int8_t quality);

/// ENU [m2]: ee en eu nn nu uu; all 0 when unknown. `noise`: of the same moment, or null.
///
/// From the best that is there: the receiver's own ellipse or deviations (GST); eph and epv; epx,
/// epy and epv. Of an RTK solution only what can be RTK's: gpsd's eph of NMEA receivers is a range
/// error of metres times the dilution of precision, and says nothing of it.
std::array<double, 6> enu_covariance(const GpsdFix& fix, const GpsdNoise* noise);

/// The fix as a measurement, utime left 0; none when it has no position.
std::optional<pose::Gnss> to_measurement(const GpsdFix& fix, const GpsdNoise* noise);

}  // namespace orchard::device
