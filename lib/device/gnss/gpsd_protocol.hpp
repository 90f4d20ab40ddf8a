// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "device/device_clock.hpp"
#include "device/gnss/gnss_driver_config.hpp"
#include "device/gnss/gpsd_report.hpp"
#include "device/lines/line_splitter.hpp"
#include "device/protocol.hpp"

namespace orchard::device {

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
  std::string condition() const override;
  ProtocolCounts counts() const override;

 private:
  void take_line(std::string_view line, std::int64_t host_utime);
  void take_fix(const GpsdFix& fix, std::int64_t host_utime);
  bool is_ours(const std::string& device);
  std::int64_t stamp(std::int64_t fix_time_us, std::int64_t host_utime);
  const GpsdNoise* noise_of(const GpsdFix& fix) const;

  GnssDriverConfig config_;
  LineSplitter lines_;
  DeviceClock clock_;
  std::string receiver_;  ///< the receiver in use; empty: none has reported yet
  std::optional<std::int64_t> last_fix_time_us_;
  std::int64_t last_utime_ = 0;
  std::optional<GpsdNoise> noise_;
  int noise_status_ = 0;  ///< status of the fix before the noise report
  int last_status_ = 0;
  std::optional<std::int64_t> deadline_;
  std::int64_t fix_utime_ = 0;  ///< arrival of the last position
  int num_unanswered_ = 0;      ///< requests since gpsd's last report
  std::optional<bool> has_receivers_;
  std::int64_t num_other_receivers_ = 0;
  double fix_lead_s_ = 0.0;  ///< stamp: fix_time: arrival minus time of the last fix
  std::string why_no_fix_;
  std::string error_;
  ProtocolCounts counts_;
};

}  // namespace orchard::device
