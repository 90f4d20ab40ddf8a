// SPDX-License-Identifier: BSD-3-Clause
#include "device/lines/controller_protocol.hpp"
#include "text/parse_number.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

namespace orchard::device {
namespace {

constexpr std::int64_t kLongestStep_us = 1'000'000;
constexpr double kWheelSpeedMax_mps = 30.0;  // a wheel of any robot that drives among trees

/// physical: a wheel pulls with its grip on the ground, which is hardly more than its weight.
constexpr double kWheelAccelerationMax_mps2 = 10.0;

constexpr double kSpeedMax_mps = 50.0;  // no vehicle among trees
constexpr double kYawRateMax_radps = 50.0;
constexpr double kAngularRateMax_radps = 100.0;  // above what inertial units measure (2000 deg/s)
constexpr double kAccelerationMax_mps2 = 400.0;
constexpr double kAngleMax_rad = 12.6;  // two turns, for who does not wrap
constexpr std::size_t kMaxWords = 16;

constexpr const char* kImpossibleStep = "faster than a wheel can accelerate";

constexpr std::string_view kSeparators = " \t,";

/// Words between blanks or commas; at most kMaxWords and one.
std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  while (words.size() <= kMaxWords) {
    const std::size_t begin = line.find_first_not_of(kSeparators);
    if (begin == std::string_view::npos) break;
    line.remove_prefix(begin);
    const std::size_t end = line.find_first_of(kSeparators);
    words.push_back(line.substr(0, end));
    if (end == std::string_view::npos) break;
    line.remove_prefix(end);
  }
  return words;
}

template <class Number>
std::optional<Number> read_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') {
    word.remove_prefix(1);
    if (word.empty() || word.front() == '-') return std::nullopt;
  }
  return parse_number<Number>(word);
}

std::optional<std::uint8_t> read_hex_byte(std::string_view text) {
  return text.size() == 2 ? parse_number<std::uint8_t>(text, 16) : std::nullopt;
}

/// The words behind a line's letter as numbers, each checked; keeps the first objection.
class Numbers {
 public:
  explicit Numbers(const std::vector<std::string_view>& words) : words_(words) {}

  std::size_t count() const { return words_.size(); }

  double real(double lo, double hi) {
    if (!why_.empty()) return 0.0;
    const std::string_view word = words_[next_++];
    const std::optional<double> number = read_number<double>(word);
    if (!number || !std::isfinite(*number)) {
      why_ = "not a number: " + std::string(word);
    } else if (*number < lo || *number > hi) {
      why_ = "out of range: " + std::string(word);
    } else {
      return *number;
    }
    return 0.0;
  }

  void reals(std::array<double, 3>& values, double limit) {
    for (double& value : values) value = real(-limit, limit);
  }

  std::int64_t whole() {
    if (!why_.empty()) return 0;
    const std::string_view word = words_[next_++];
    const std::optional<std::int64_t> number = read_number<std::int64_t>(word);
    if (!number) why_ = "not a whole number: " + std::string(word);
    return number.value_or(0);
  }

  const std::string& why() const { return why_; }

 private:
  const std::vector<std::string_view>& words_;
  std::size_t next_ = 0;
  std::string why_;
};

/// Fills a line by its letter; returns why not, or nothing.
std::string fill(SensorLine& line, std::string_view letter, Numbers& numbers) {
  const std::size_t count = numbers.count();
  if (letter == "V") {
    if (count != 2 && count != 4)
      return "V needs speed and yaw rate, optionally with their standard deviations";
    VelocityLine velocity;
    velocity.speed_mps = numbers.real(-kSpeedMax_mps, kSpeedMax_mps);
    velocity.yaw_rate_radps = numbers.real(-kYawRateMax_radps, kYawRateMax_radps);
    if (count == 4) {
      velocity.speed_sd_mps = numbers.real(0.0, kSpeedMax_mps);
      velocity.yaw_rate_sd_radps = numbers.real(0.0, kYawRateMax_radps);
    }
    line.content = velocity;
  } else if (letter == "T") {
    if (count != 2) return "T needs the counts of the left and the right wheel";
    TickLine ticks;
    ticks.left = numbers.whole();
    ticks.right = numbers.whole();
    line.content = ticks;
  } else if (letter == "I") {
    if (count != 6 && count != 9)
      return "I needs 3 rates and 3 accelerations, optionally with 3 angles";
    InertialLine inertial;
    numbers.reals(inertial.angular_rate_radps, kAngularRateMax_radps);
    numbers.reals(inertial.acceleration_mps2, kAccelerationMax_mps2);
    inertial.has_orientation = count == 9;
    if (inertial.has_orientation) numbers.reals(inertial.orientation_rad, kAngleMax_rad);
    line.content = inertial;
  } else {
    return "begins with none of V, T, I and #";
  }
  return numbers.why();
}

constexpr std::size_t kLongestLine_bytes = 200;
constexpr std::int64_t kSilence_us = 1'000'000;
constexpr std::int64_t kGiveUp_us = 10'000'000;  // a controller boots in less
constexpr std::size_t kShownBytes = 40;

using Matrix = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

/// Yaw about z, then pitch about y, then roll about x.
Matrix rotation(const std::array<double, 3>& rpy_rad) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(rpy_rad[2], Vector3d::UnitZ()) * AngleAxisd(rpy_rad[1], Vector3d::UnitY()) *
          AngleAxisd(rpy_rad[0], Vector3d::UnitX()))
      .toRotationMatrix();
}

std::array<double, 3> rotated(const Matrix& R, const std::array<double, 3>& vector) {
  const Eigen::Vector3d turned = R * Eigen::Map<const Eigen::Vector3d>(vector.data());
  return {turned.x(), turned.y(), turned.z()};
}

}  // namespace

WheelTicks::Outcome WheelTicks::add(const TickLine& ticks, std::int64_t utime) {
  if (before_ && utime <= before_->utime) return Outcome::kNoTime;
  earlier_ = std::exchange(before_, Stand{ticks, utime});
  const std::optional<Stand>& before = earlier_;
  if (!before || utime - before->utime > kLongestStep_us) return Outcome::kFirst;
  const std::int64_t step_us = utime - before->utime;
  const double step_s = 1e-6 * static_cast<double>(step_us);
  const double left_m = moved_m(before->ticks.left, ticks.left, config_.metres_per_tick[0]);
  const double right_m = moved_m(before->ticks.right, ticks.right, config_.metres_per_tick[1]);
  const double max_m = kWheelSpeedMax_mps * step_s;
  if (std::abs(left_m) > max_m || std::abs(right_m) > max_m) return Outcome::kJumped;
  odometry_.utime = utime;
  odometry_.speed_mps = (left_m + right_m) / 2.0 / step_s;
  odometry_.yaw_rate_radps = (right_m - left_m) / config_.wheel_distance_m / step_s;
  return Outcome::kMoved;
}

double WheelTicks::moved_m(std::int64_t from, std::int64_t to, double metres_per_tick) const {
  // Modulo 2^counter_bits, the shorter way round: signed and unsigned counters alike.
  const int unused_bits = 64 - config_.counter_bits;
  const std::uint64_t forward = static_cast<std::uint64_t>(to) - static_cast<std::uint64_t>(from);
  const auto ticks = static_cast<std::int64_t>(forward << unused_bits) >> unused_bits;
  return static_cast<double>(ticks) * metres_per_tick;
}

void WheelTicks::shift_time(std::int64_t step_us) {
  if (before_) before_->utime += step_us;
}

bool AccelerationCheck::is_possible(const pose::Odometry& odometry, double resolution_m) {
  const Last now{odometry.speed_mps, odometry.yaw_rate_radps, odometry.utime};
  if (!last_ || now.utime - last_->utime > kLongestStep_us || now.utime <= last_->utime) {
    first_utime_ = now.utime;
    num_steps_ = 0;
    is_refused_ = false;
    last_ = now;
    return true;
  }
  // Lines are sent at a steady rate, whatever the line and the host make of it.
  ++num_steps_;
  const double mean_step_s = 1e-6 * static_cast<double>(now.utime - first_utime_) / num_steps_;
  const double step_s = std::max(1e-6 * static_cast<double>(now.utime - last_->utime), mean_step_s);
  const double change_mps = std::abs(now.speed_mps - last_->speed_mps) +
                            half_distance_m_ * std::abs(now.yaw_rate_radps - last_->yaw_rate_radps);
  const double max_mps = kWheelAccelerationMax_mps2 * step_s + 2.0 * resolution_m / step_s;
  is_refused_ = !is_refused_ && change_mps > max_mps;
  if (!is_refused_) last_ = now;
  return !is_refused_;
}

void AccelerationCheck::shift_time(std::int64_t step_us) {
  if (last_) last_->utime += step_us;
  first_utime_ += step_us;
}

std::uint8_t line_checksum(std::string_view bytes) {
  std::uint8_t sum = 0;
  for (const char byte : bytes)
    sum = static_cast<std::uint8_t>(sum ^ static_cast<std::uint8_t>(byte));
  return sum;
}

std::variant<SensorLine, Comment, BadLine> parse_sensor_line(std::string_view text) {
  if (!text.empty() && text.front() == '#') return Comment{};
  SensorLine line;
  if (const std::size_t star = text.rfind('*'); star != std::string_view::npos) {
    const std::optional<std::uint8_t> stated = read_hex_byte(text.substr(star + 1));
    if (!stated) return BadLine{"the checksum is not two hexadecimal digits"};
    text = text.substr(0, star);
    if (*stated != line_checksum(text)) return BadLine{"the checksum is wrong"};
    line.has_checksum = true;
  }
  std::vector<std::string_view> words = split_words(text);
  if (words.empty()) return Comment{};
  if (words.size() > kMaxWords) return BadLine{"too many words"};
  if (words.back().front() == '@') {
    const auto time = read_number<std::int64_t>(words.back().substr(1));
    if (!time || *time < 0) return BadLine{"@ needs a time in whole microseconds"};
    line.device_time_us = *time;
    words.pop_back();
    if (words.empty()) return BadLine{"a time without a measurement"};
  }
  const std::string_view letter = words.front();
  words.erase(words.begin());
  Numbers numbers(words);
  if (std::string why = fill(line, letter, numbers); !why.empty()) return BadLine{std::move(why)};
  return line;
}

ControllerProtocol::ControllerProtocol(const OdometryDriverConfig& odometry,
                                       const ImuDriverConfig& imu)
    : lines_(kLongestLine_bytes),
      ticks_(odometry),
      metres_per_tick_(
          std::max(std::abs(odometry.metres_per_tick[0]), std::abs(odometry.metres_per_tick[1]))),
      acceleration_(odometry.wheel_distance_m),
      clock_(32, 1.0) {
  const Matrix R = rotation(imu.mount_rad);
  std::copy_n(R.data(), R_base_imu_.size(), R_base_imu_.begin());
}

void ControllerProtocol::connected(std::int64_t host_utime) {
  lines_.restart(true);
  ticks_.restart();
  acceleration_.restart();
  clock_.begin_connection();
  needs_checksum_ = false;
  is_given_up_ = false;
  is_silent_ = true;
  is_heard_ = false;
  heard_utime_ = host_utime;
  deadline_ = host_utime + kSilence_us;
}

void ControllerProtocol::receive(std::string_view bytes, std::int64_t host_utime) {
  lines_.add(bytes, [&](std::string_view line) { take_line(line, host_utime); });
}

void ControllerProtocol::expire(std::int64_t host_utime) {
  is_silent_ = true;
  is_given_up_ = host_utime - heard_utime_ >= kGiveUp_us;
  deadline_ = host_utime + kSilence_us;
}

void ControllerProtocol::host_clock_stepped(std::int64_t step_us) {
  clock_.host_stepped(step_us);
  units_.host_clock_stepped();
  if (!ticks_by_device_clock_) ticks_.shift_time(step_us);
  acceleration_.shift_time(step_us);
  heard_utime_ += step_us;
  odometry_utime_ += step_us;
  imu_utime_ += step_us;
  if (deadline_) *deadline_ += step_us;
}

std::string ControllerProtocol::failure() const {
  return is_given_up_ ? "no valid line for 10 s" : "";
}

Condition ControllerProtocol::condition() const {
  if (!is_silent_) {
    const std::string refused = units_.warning("lines");
    return {refused.empty() ? Severity::kNone : Severity::kWarning, refused};
  }
  const bool is_refused = !last_refused_.empty();
  const Severity severity = is_heard_    ? Severity::kError
                            : is_refused ? Severity::kWarning
                                         : Severity::kWaiting;
  if (is_refused) return {severity, "waits for a valid line; refused \"" + last_refused_ + ")"};
  return {severity,
          "waits for lines; check that the controller is running and the baud rate is right"};
}

ProtocolCounts ControllerProtocol::counts() const {
  ProtocolCounts counts = units_.counts();
  counts.num_bad += lines_.num_too_long();
  return counts;
}

void ControllerProtocol::take_line(std::string_view text, std::int64_t host_utime) {
  const auto parsed = parse_sensor_line(text);
  if (const auto* bad = std::get_if<BadLine>(&parsed)) return refuse(text, bad->why, host_utime);
  const auto* line = std::get_if<SensorLine>(&parsed);
  if (line == nullptr) return;
  if (needs_checksum_ && !line->has_checksum)
    return refuse(text, "its checksum is missing", host_utime);
  needs_checksum_ = line->has_checksum;
  if (const std::string why = use(*line, host_utime); !why.empty())
    return refuse(text, why, host_utime);
  units_.add_good(host_utime);
  last_refused_.clear();
  is_silent_ = false;
  is_heard_ = true;
  heard_utime_ = host_utime;
  deadline_ = host_utime + kSilence_us;
}

void ControllerProtocol::refuse(std::string_view text, const std::string& why,
                                std::int64_t host_utime) {
  last_refused_ = shown_text(text, kShownBytes) + "\" (" + shown_text(why, kShownBytes);
  units_.add_refused(host_utime, "\"" + last_refused_ + ")");
}

std::string ControllerProtocol::use(const SensorLine& line, std::int64_t host_utime) {
  double time_us = 0.0;
  std::int64_t utime = host_utime;
  if (line.device_time_us) {
    time_us = clock_.arrived(static_cast<std::uint32_t>(*line.device_time_us), host_utime);
    utime = clock_.host_utime(time_us);
    if (clock_.num_restarts() != num_restarts_) {
      num_restarts_ = clock_.num_restarts();
      ticks_.restart();
    }
  }
  if (const auto* velocity = std::get_if<VelocityLine>(&line.content)) {
    return add_velocity(line, *velocity, utime);
  } else if (const auto* ticks = std::get_if<TickLine>(&line.content)) {
    return add_ticks(line, *ticks, time_us, utime);
  } else {
    add_inertial(std::get<InertialLine>(line.content), utime);
  }
  return {};
}

std::string ControllerProtocol::add_velocity(const SensorLine& line, const VelocityLine& velocity,
                                             std::int64_t utime) {
  pose::Odometry odometry;
  odometry.utime = utime;
  odometry.speed_mps = velocity.speed_mps;
  odometry.yaw_rate_radps = velocity.yaw_rate_radps;
  odometry.covariance = {velocity.speed_sd_mps * velocity.speed_sd_mps, 0.0,
                         velocity.yaw_rate_sd_radps * velocity.yaw_rate_sd_radps};
  if (!is_possible(line, odometry, 0.0)) return kImpossibleStep;
  add(odometry, odometry_utime_);
  return {};
}

bool ControllerProtocol::is_possible(const SensorLine& line, const pose::Odometry& odometry,
                                     double resolution_m) {
  return line.has_checksum || acceleration_.is_possible(odometry, resolution_m);
}

std::string ControllerProtocol::add_ticks(const SensorLine& line, const TickLine& ticks,
                                          double time_us, std::int64_t utime) {
  const bool by_device_clock = line.device_time_us.has_value();
  if (by_device_clock != ticks_by_device_clock_) ticks_.restart();
  ticks_by_device_clock_ = by_device_clock;
  // The controller's own clock gives the step without the jitter of the line.
  const auto outcome = ticks_.add(ticks, by_device_clock ? std::llround(time_us) : utime);
  if (outcome == WheelTicks::Outcome::kJumped) return "a jump larger than a wheel can turn";
  if (outcome == WheelTicks::Outcome::kNoTime && by_device_clock) {
    return "its time is not later than that of the previous line";
  }
  if (outcome != WheelTicks::Outcome::kMoved) return {};
  pose::Odometry odometry = ticks_.odometry();
  if (by_device_clock) odometry.utime = clock_.host_utime(static_cast<double>(odometry.utime));
  if (!is_possible(line, odometry, metres_per_tick_)) {
    ticks_.take_back();
    return kImpossibleStep;
  }
  add(odometry, odometry_utime_);
  return {};
}

void ControllerProtocol::add_inertial(const InertialLine& line, std::int64_t utime) {
  const Matrix R_base_imu = Eigen::Map<const Matrix>(R_base_imu_.data());
  pose::Imu imu;
  imu.utime = utime;
  imu.angular_rate_radps = rotated(R_base_imu, line.angular_rate_radps);
  imu.acceleration_mps2 = rotated(R_base_imu, line.acceleration_mps2);
  imu.has_orientation = line.has_orientation;
  if (line.has_orientation) {
    const Matrix R = rotation(line.orientation_rad) * R_base_imu.transpose();
    imu.roll_rad = std::atan2(R(2, 1), R(2, 2));
    imu.pitch_rad = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
    imu.yaw_rad = std::atan2(R(1, 0), R(0, 0));
  }
  add(imu, imu_utime_);
}

template <class M>
void ControllerProtocol::add(M measurement, std::int64_t& last_utime) {
  // Stamps only rise, also when lines arrive together or the clock's line is fitted anew.
  if (measurement.utime <= last_utime) measurement.utime = last_utime + 1;
  last_utime = measurement.utime;
  measurements_.emplace_back(measurement);
}

}  // namespace orchard::device
