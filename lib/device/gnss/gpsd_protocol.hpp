// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "device/device_clock.hpp"
#include "device/drivers_config.hpp"
#include "device/lines/line_splitter.hpp"
#include "device/protocol.hpp"
#include "pose/measurements.hpp"

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

/// NMEA GGA quality of a gpsd fix.
std::int8_t gga_quality(const GpsdFix& fix);

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

/// Protocol of gpsd: requests reports and converts each new fix to a measurement.
class GpsdProtocol : public Protocol {
 public:
  explicit GpsdProtocol(const GnssDriverConfig& config);

  void connected(std::int64_t host_utime) override;
  void receive(std::string_view bytes, std::int64_t host_utime) override;
  std::optional<std::int64_t> deadline() const override { return deadline_; }
  void expire(std::int64_t host_utime) override;
  void host_clock_stepped(std::int64_t step_us) override;
  std::string failure() const override;
  Condition condition() const override;
  ProtocolCounts counts() const override;

 private:
  void take_line(std::string_view line, std::int64_t host_utime);
  Condition why_no_fix() const;
  void take_fix(const GpsdFix& fix, std::int64_t host_utime);
  void publish(pose::Gnss gnss);
  bool is_ours(const std::string& device);
  std::int64_t stamp(std::int64_t fix_time_us, std::int64_t host_utime);
  const GpsdNoise* noise_of(const GpsdFix& fix) const;

  GnssDriverConfig config_;
  LineSplitter lines_;
  DeviceClock clock_;
  std::string receiver_;  ///< the receiver in use; empty: none has reported yet
  std::optional<std::int64_t> last_fix_time_us_;
  std::int64_t last_utime_ = 0;
  /// The last fix while a later report may have its height or status; published with the next one
  /// where none does.
  std::optional<pose::Gnss> incomplete_;
  bool has_status_ = false;  ///< the receiver's fixes have one, if not in their first report
  std::optional<GpsdNoise> noise_;
  int noise_status_ = 0;  ///< status of the fix before the noise report
  int last_status_ = 0;
  std::optional<std::int64_t> deadline_;
  std::int64_t fix_utime_ = 0;  ///< arrival of the last position
  int num_unanswered_ = 0;      ///< requests since gpsd's last report
  std::optional<bool> has_receivers_;
  std::int64_t num_other_receivers_ = 0;
  double fix_lead_s_ = 0.0;  ///< stamp: fix_time: arrival minus time of the last fix
  Condition no_fix_;         ///< why there is none
  std::string error_;
  UnitCounter units_;
};

}  // namespace orchard::device
