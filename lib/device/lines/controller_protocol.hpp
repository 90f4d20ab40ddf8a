// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "device/device_clock.hpp"
#include "device/lines/line_splitter.hpp"
#include "device/lines/odometry_driver_config.hpp"
#include "device/lines/sensor_line.hpp"
#include "device/lines/wheel_ticks.hpp"
#include "device/protocol.hpp"

namespace orchard::device {

/// A robot's controller that sends text lines: wheel velocities, wheel ticks, an inertial unit. It
/// is only listened to. The page of this folder describes the lines.
class ControllerProtocol : public Protocol {
 public:
  ControllerProtocol(const OdometryDriverConfig& odometry, const ImuDriverConfig& imu);

  void connected(std::int64_t host_utime) override;
  void receive(std::string_view bytes, std::int64_t host_utime) override;
  std::optional<std::int64_t> deadline() const override { return deadline_; }
  void expire(std::int64_t host_utime) override;
  void host_clock_stepped(std::int64_t step_us) override;
  std::string failure() const override;
  std::string condition() const override;
  ProtocolCounts counts() const override;

 private:
  void take_line(std::string_view text, std::int64_t host_utime);
  void refuse(std::string_view text, const std::string& why);
  std::string use(const SensorLine& line, std::int64_t host_utime);
  void add_velocity(const VelocityLine& line, std::int64_t utime);
  std::string add_ticks(const SensorLine& line, const TickLine& ticks, double time_us,
                        std::int64_t utime);
  void add_inertial(const InertialLine& line, std::int64_t utime);
  template <class M>
  void add(M measurement, std::int64_t& last_utime);

  std::array<double, 9> R_base_imu_;  ///< row by row
  LineSplitter lines_;
  WheelTicks ticks_;
  DeviceClock clock_;
  bool ticks_by_device_clock_ = false;
  bool needs_checksum_ = false;  ///< since a line of this connection had one
  std::int64_t heard_utime_ = 0;
  std::optional<std::int64_t> deadline_;
  bool is_silent_ = true;
  bool is_given_up_ = false;
  std::int64_t num_restarts_ = 0;  ///< of the controller, as its clock tells
  std::int64_t odometry_utime_ = 0;
  std::int64_t imu_utime_ = 0;
  std::string last_refused_;  ///< the last line that was refused and why, since one was good
  ProtocolCounts counts_;
};

}  // namespace orchard::device
