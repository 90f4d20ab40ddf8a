// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/leveller.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "timing/units.hpp"

namespace orchard::pose {
namespace {

// physical: without wheels the speed is unknown; robots in orchards drive at a walking pace.
constexpr double kWalk_mps = 1.0;

// derived: longer than a live process holds the first messages of a channel until others confirm
// them, several periods of a slow unit.
constexpr std::int64_t kWait_us = 500'000;

timing::OrderedQueue<Leveller::Input, 4>::Rules rules_of(const LevellingConfig& config) {
  timing::OrderedQueue<Leveller::Input, 4>::Rules rules;
  rules[0].wait_us = kWait_us;
  if (config.has_wheels) rules[1].wait_us = kWait_us;
  return rules;
}

std::int64_t last_beam_utime(const laser::Scan& scan) {
  const double num_periods = std::max<double>(1.0, static_cast<double>(scan.ranges_m.size())) - 1.0;
  return scan.utime + std::llround(num_periods * scan.beam_period_us);
}

}  // namespace

Leveller::Leveller(const LevellingConfig& config)
    : config_(config),
      queue_(rules_of(config)),
      ground_(config.objects.range_max_m),
      front_(config.laser, config.objects.jump_m, config.objects.jump_fraction),
      rear_(config.laser_rear, config.objects.jump_m, config.objects.jump_fraction),
      speed_mps_(config.has_wheels ? 0.0 : kWalk_mps) {}

void Leveller::add(Input input) {
  const std::int64_t utime = std::visit([](const auto& m) { return m.utime; }, input);
  const std::size_t kind = input.index();
  if (kind == 0) is_imu_missing_ = false;
  if (kind == 0 || (kind == 1 && config_.has_wheels)) queue_.set_wait(kind, kWait_us);
  queue_.push(kind, utime, std::move(input));
}

/// Nobody waits again for a kind that was waited for in vain, until it comes.
void Leveller::give_up_late(std::int64_t utime) {
  for (const std::size_t kind : {std::size_t{0}, std::size_t{1}}) {
    if (queue_.reached(kind) < utime) queue_.set_wait(kind, std::nullopt);
  }
  is_imu_missing_ = is_imu_missing_ || queue_.reached(0) < utime;
}

std::optional<Leveller::Input> Leveller::take() {
  return take_of([this] { return queue_.pop(); }, false);
}

std::optional<Leveller::Input> Leveller::take_flushed() {
  return take_of([this] { return queue_.pop_flushed(); }, true);
}

/// The next scan whose sweep the tilt covers, else what `pop` gives, scans put aside.
template <class Pop>
std::optional<Leveller::Input> Leveller::take_of(const Pop& pop, bool is_end) {
  while (!is_swept(false)) {
    std::optional<Input> next = pop();
    if (!next) {
      if (!is_swept(is_end)) return std::nullopt;
      break;
    }
    give_up_late(std::visit([](const auto& m) { return m.utime; }, *next));
    const bool is_scan =
        !std::holds_alternative<Imu>(*next) && !std::holds_alternative<Odometry>(*next);
    if (!is_scan) return levelled(*std::move(next));
    sweeps_.push_back(*std::move(next));
  }
  Input scan = std::move(sweeps_.front());
  sweeps_.pop_front();
  return levelled(std::move(scan));
}

/// Whether the first scan put aside waits no longer: for the tilt at its last beam, whenever that
/// arrives, or because it is late.
bool Leveller::is_swept(bool is_end) const {
  if (sweeps_.empty()) return false;
  const auto* rear = std::get_if<laser::RearScan>(&sweeps_.front());
  const laser::Scan& scan = rear != nullptr ? *rear : std::get<laser::Scan>(sweeps_.front());
  const std::int64_t utime = last_beam_utime(scan);
  const bool is_late = queue_.message_time() - utime > kWait_us;
  return is_end || newest_imu_utime_ >= utime || is_late || is_imu_missing_;
}

Leveller::Input Leveller::levelled(Input input) {
  std::visit([this](auto& m) { level(m); }, input);
  return input;
}

std::optional<Attitude> Leveller::tilt_at(std::int64_t utime) const {
  const std::optional<Attitude> attitude = attitude_.at(utime);
  return attitude && is_upright(*attitude) ? attitude : std::nullopt;
}

void Leveller::level(Imu& imu) {
  attitude_.add(imu);
  newest_imu_utime_ = std::max(newest_imu_utime_, imu.utime);
  const std::optional<Attitude> attitude = tilt_at(imu.utime);
  if (!attitude) return;
  if (imu_utime_ && imu.utime > *imu_utime_) {
    const double time_s = std::min(1.0, timing::seconds(imu.utime - *imu_utime_));
    ground_.add(*attitude, std::abs(speed_mps_) * time_s, attitude_.heading_rate_radps() * time_s);
  } else if (!imu_utime_) {
    ground_.add(*attitude, 0.0, 0.0);
  }
  imu_utime_ = imu.utime;
  imu.angular_rate_radps[2] =
      heading_rate_radps(*attitude, imu.angular_rate_radps[1], imu.angular_rate_radps[2]);
}

void Leveller::level(Odometry& odometry) {
  attitude_.add(odometry);
  if (config_.has_wheels) speed_mps_ = odometry.speed_mps;
  const std::optional<Attitude> attitude = tilt_at(odometry.utime);
  if (!attitude) return;
  odometry.speed_mps *= std::cos(attitude->pitch_rad);
  odometry.yaw_rate_radps = heading_rate_radps(*attitude, 0.0, odometry.yaw_rate_radps);
}

void Leveller::level(laser::Scan& scan) { level(scan, front_); }
void Leveller::level(laser::RearScan& scan) { level(scan, rear_); }

void Leveller::level(laser::Scan& scan, ScanLeveller& leveller) {
  if (scan.ranges_m.empty()) return;  // of which only the time is used
  ++num_scans_;
  const std::optional<Attitude> first = tilt_at(scan.utime);
  const std::optional<Attitude> last = tilt_at(last_beam_utime(scan));
  if (first && last) {
    leveller.level(scan, *first, *last, ground_);
  } else {
    ++num_unlevelled_;
  }
}

std::string Leveller::warning() const {
  if (num_unlevelled_ == 0) return {};
  return "no upright tilt by an IMU (from the imu driver) for " + std::to_string(num_unlevelled_) +
         " of " + std::to_string(num_scans_) +
         " scans: they are taken as level, and returns of the ground as objects; without an IMU "
         "set laser.height_m to 0";
}

}  // namespace orchard::pose
