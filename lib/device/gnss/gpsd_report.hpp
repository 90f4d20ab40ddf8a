// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace orchard::device {

/// A TPV report of gpsd: time and position. Fields that the receiver does not report are absent.
struct GpsdFix {
  std::string device;
  int mode = 0;    ///< 0 unknown, 1 no fix, 2 without height, 3 with
  int status = 0;  ///< 0 or absent: unknown; 2 DGPS, 3 RTK fixed, 4 RTK float, ...
  std::optional<std::int64_t> time_us;  ///< UTC since 1970
  std::optional<double> latitude_deg;
  std::optional<double> longitude_deg;
  std::optional<double> altitude_m;  ///< above the ellipsoid
  std::optional<double> eph_m;       ///< horizontal error
  std::optional<double> epx_m;       ///< east error
  std::optional<double> epy_m;
  std::optional<double> epv_m;
};

/// A GST report: the receiver's own standard deviations.
struct GpsdNoise {
  std::string device;
  std::optional<std::int64_t> time_us;
  std::optional<double> north_sd_m;
  std::optional<double> east_sd_m;
  std::optional<double> up_sd_m;
  std::optional<double> major_sd_m;  ///< of the error ellipse
  std::optional<double> minor_sd_m;
  std::optional<double> orientation_deg;  ///< of the major axis, from north to east
};

/// A DEVICES report: the receivers known to gpsd.
struct GpsdDevices {
  std::vector<std::string> paths;
};

/// An ERROR report.
struct GpsdError {
  std::string message;
};

/// A report of a class that is ignored (SKY, VERSION, WATCH, ...).
struct GpsdOther {};

/// A line that is no valid report.
struct GpsdBad {
  std::string why;
};

using GpsdReport = std::variant<GpsdOther, GpsdFix, GpsdNoise, GpsdDevices, GpsdError, GpsdBad>;

/// Parses one line of gpsd's JSON (gpsd_json(5)); accepts any bytes. Malformed, non-finite or
/// impossible numbers give GpsdBad.
GpsdReport parse_gpsd_report(std::string_view line);

/// Parses a time such as "2026-05-04T10:11:12.250Z" to microseconds since 1970; none when
/// malformed.
std::optional<std::int64_t> parse_utc(std::string_view text);

}  // namespace orchard::device
