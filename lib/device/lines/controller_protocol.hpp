// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "device/device_clock.hpp"
#include "device/drivers_config.hpp"
#include "device/lines/line_splitter.hpp"
#include "device/protocol.hpp"
#include "pose/measurements.hpp"

namespace orchard::device {

/// `V speed yaw_rate [speed_sd yaw_rate_sd]`: the robot's velocity.
struct VelocityLine {
  double speed_mps = 0.0;
  double yaw_rate_radps = 0.0;
  double speed_sd_mps = 0.0;  ///< both 0: unknown
  double yaw_rate_sd_radps = 0.0;
};

/// `T left right`: what the wheels' counters stand at.
struct TickLine {
  std::int64_t left = 0;
  std::int64_t right = 0;
};

/// `I gx gy gz ax ay az [roll pitch yaw]`: an inertial unit's sample, in its own axes.
struct InertialLine {
  std::array<double, 3> angular_rate_radps{};
  std::array<double, 3> acceleration_mps2{};
  std::array<double, 3> orientation_rad{};  ///< roll, pitch, yaw
  bool has_orientation = false;
};

/// One line of a robot's controller. The page of this folder describes the format.
struct SensorLine {
  std::variant<VelocityLine, TickLine, InertialLine> content;
  std::optional<std::int64_t> device_time_us;  ///< `@time`: by the controller's own clock
  bool has_checksum = false;
};

/// Nothing for us: a comment.
struct Comment {};

/// Why a line was refused, in words for a person.
struct BadLine {
  std::string why;
};

/// Reads a line without its end: any bytes are a line, a comment or bad.
std::variant<SensorLine, Comment, BadLine> parse_sensor_line(std::string_view line);

/// The checksum that follows `*`: all bytes before it, exclusive-or.
std::uint8_t line_checksum(std::string_view bytes);

/// From what the wheels' counters stand at to velocities of base: the mean over the step between
/// two lines, stamped at its end. A line that was lost costs no distance, since counters go on.
class WheelTicks {
 public:
  /// What a line gave.
  enum class Outcome {
    kMoved,   ///< odometry()
    kFirst,   ///< the first, or the first after more than a second: the next one has a step
    kNoTime,  ///< no later than the one before: refused
    kJumped,  ///< faster than any robot drives: the controller was restarted; begins anew
  };

  explicit WheelTicks(const OdometryDriverConfig& config) : config_(config) {}

  /// `utime`: when the counters stood there [us].
  Outcome add(const TickLine& ticks, std::int64_t utime);

  /// Of the last kMoved; its covariance is unknown.
  const pose::Odometry& odometry() const { return odometry_; }

  /// The clock of `utime` was set by that much [us].
  void shift_time(std::int64_t step_us);

  /// The next line is a first one.
  void restart() { before_.reset(); }

  /// The last kMoved was refused: the next step begins where that one did.
  void take_back() { before_ = earlier_; }

 private:
  struct Stand {
    TickLine ticks;
    std::int64_t utime;
  };
  double moved_m(std::int64_t from, std::int64_t to, double metres_per_tick) const;

  OdometryDriverConfig config_;
  std::optional<Stand> before_;
  std::optional<Stand> earlier_;
  pose::Odometry odometry_;
};

/// Finds a damaged digit in lines without a checksum: a speed that no wheel reaches in one step.
class AccelerationCheck {
 public:
  explicit AccelerationCheck(double wheel_distance_m) : half_distance_m_(wheel_distance_m / 2.0) {}

  /// Whether the wheels can have this speed after that of the line before; twice in a row they
  /// must have it. `resolution_m`: of the way of a wheel in a step.
  bool is_possible(const pose::Odometry& odometry, double resolution_m);

  void restart() { last_.reset(); }
  void shift_time(std::int64_t step_us);

 private:
  struct Last {
    double speed_mps;
    double yaw_rate_radps;
    std::int64_t utime;
  };
  double half_distance_m_;
  std::optional<Last> last_;
  std::int64_t first_utime_ = 0;  ///< of the lines since the restart
  int num_steps_ = 0;             ///< since then
  bool is_refused_ = false;       ///< the line before
};

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
  Condition condition() const override;
  ProtocolCounts counts() const override;

 private:
  void take_line(std::string_view text, std::int64_t host_utime);
  void refuse(std::string_view text, const std::string& why, std::int64_t host_utime);
  std::string use(const SensorLine& line, std::int64_t host_utime);
  std::string add_velocity(const SensorLine& line, const VelocityLine& velocity,
                           std::int64_t utime);
  std::string add_ticks(const SensorLine& line, const TickLine& ticks, double time_us,
                        std::int64_t utime);
  void add_inertial(const InertialLine& line, std::int64_t utime);
  bool is_possible(const SensorLine& line, const pose::Odometry& odometry, double resolution_m);
  template <class M>
  void add(M measurement, std::int64_t& last_utime);

  std::array<double, 9> R_base_imu_;  ///< row by row
  LineSplitter lines_;
  WheelTicks ticks_;
  double metres_per_tick_;  ///< the larger one
  AccelerationCheck acceleration_;
  DeviceClock clock_;
  bool ticks_by_device_clock_ = false;
  bool needs_checksum_ = false;  ///< since a line of this connection had one
  std::int64_t heard_utime_ = 0;
  std::optional<std::int64_t> deadline_;
  bool is_silent_ = true;
  bool is_heard_ = false;  ///< a valid line has come since the connection was made
  bool is_given_up_ = false;
  std::int64_t num_restarts_ = 0;  ///< of the controller, as its clock tells
  std::int64_t odometry_utime_ = 0;
  std::int64_t imu_utime_ = 0;
  std::string last_refused_;  ///< the last line that was refused and why, since one was good
  UnitCounter units_;
};

}  // namespace orchard::device
