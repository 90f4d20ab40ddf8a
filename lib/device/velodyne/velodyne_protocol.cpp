// SPDX-License-Identifier: BSD-3-Clause
#include "device/velodyne/velodyne_protocol.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <variant>

#include "geometry/angles.hpp"

namespace orchard::device {
namespace {

using Packet = VelodynePacket;

// physical: the scanner counts microseconds of the hour.
constexpr double kHour_us = 3600e6;

// derived: 4 ms at most, in which a switch hands on hundreds of packets.
constexpr std::size_t kMaxHeld = 3;

// derived: a packet that comes later than this was not overtaken: the scanner's clock was set.
constexpr double kMaxLate_us = 50e3;

// derived: two turns of the slowest head and a half: what was measured before is no part of a turn
// now.
constexpr double kMaxGap_us = 500e3;

// derived: a thousand packets.
constexpr std::int64_t kMaxSilence_us = 1'000'000;

// derived: a head does not change its speed by so much within a turn.
constexpr double kSlower = 1.1;

// physical: nearest return by the data sheet [m].
constexpr double kNearest_m = 0.5;

constexpr double kTurn_cdeg = Packet::kTurn_cdeg;

constexpr double kMinute_us = 60e6;
constexpr double kCdeg_rad = 2.0 * geometry::kPi / kTurn_cdeg;

/// From one stamp to another, in -1800 s to 1800 s.
double since_us(std::uint32_t from_us, std::uint32_t to_us) {
  return std::remainder(static_cast<double>(to_us) - static_cast<double>(from_us), kHour_us);
}

laser::LayerPlan plan_for(const VelodyneMount& mount) {
  laser::LayerGeometry geometry;
  geometry.scanner_height_m = mount.scanner_height_m;
  geometry.plane_height_m = mount.plane_height_m;
  for (std::size_t i = 0; i < Packet::kNumLasers; ++i) {
    geometry.elevations_rad.push_back(vlp16_elevation_rad(i));
  }
  return laser::LayerPlan(geometry);
}

}  // namespace

VelodyneProtocol::VelodyneProtocol(const VelodyneMount& mount)
    : ScannerSession(DeviceClock::wrapping_after(kHour_us)), plan_(plan_for(mount)) {
  for (std::size_t i = 0; i < Packet::kNumLasers; ++i) {
    if (plan_.uses(i)) lasers_.push_back(i);
    mean_shot_us_ += plan_.uses(i) ? Packet::kLaser_us * static_cast<double>(i) : 0.0;
    level_m_per_unit_[i] =
        Packet::kRangeUnit_m * static_cast<float>(std::cos(vlp16_elevation_rad(i)));
  }
  mean_shot_us_ /= static_cast<double>(std::max<std::size_t>(1, lasers_.size()));
}

void VelodyneProtocol::connected(std::int64_t host_utime) {
  reset_session();
  held_.clear();
  stamp_us_.reset();
  forget_turn();
  deadline_utime_ = host_utime + kMaxSilence_us;
}

void VelodyneProtocol::forget_turn() {
  turn_.reset();
  turned_cdeg_.reset();
}

void VelodyneProtocol::refuse(std::string why, std::int64_t host_utime) {
  if (!is_streaming_) trouble_ = {Severity::kError, why};
  packets_.add_refused(host_utime, std::move(why));
}

void VelodyneProtocol::receive(std::string_view bytes, std::int64_t host_utime) {
  deadline_utime_ = host_utime + kMaxSilence_us;
  auto parsed = Packet::parse(bytes);
  if (auto* why = std::get_if<std::string>(&parsed)) return refuse(std::move(*why), host_utime);
  const auto& packet = std::get<Packet>(parsed);
  if (stamp_us_) {
    const double ahead_us = since_us(*stamp_us_, packet.stamp_us());
    if (ahead_us <= 0.0 && ahead_us >= -kMaxLate_us) {
      return refuse("a packet came twice, or later than three that follow it", host_utime);
    }
    if (ahead_us < 0.0 || ahead_us > kMaxGap_us) {
      for (const Held& held : std::exchange(held_, {})) take(held);
      stamp_us_.reset();
      forget_turn();
    }
  }
  hold({packet, host_utime});
}

/// Keeps the newest few packets in order, and takes the oldest of more.
void VelodyneProtocol::hold(Held held) {
  const std::uint32_t stamp_us = held.packet.stamp_us();
  const auto after = std::find_if(held_.begin(), held_.end(), [&](const Held& other) {
    return since_us(other.packet.stamp_us(), stamp_us) <= 0.0;
  });
  if (after != held_.end() && after->packet.stamp_us() == stamp_us) {
    return refuse("a packet came twice, or later than three that follow it", held.host_utime);
  }
  held_.insert(after, std::move(held));
  if (held_.size() <= kMaxHeld) return;
  const Held oldest = std::move(held_.front());
  held_.erase(held_.begin());
  take(oldest);
}

void VelodyneProtocol::take(const Held& held) {
  const Packet& packet = held.packet;
  if (stamp_us_) {
    const double gap_us = since_us(*stamp_us_, packet.stamp_us());
    now_us_ += gap_us;
    const auto num_lost = std::lround(gap_us / packet.duration_us()) - 1;
    if (gap_us > kMaxGap_us) forget_turn();
    for (long i = 0; i < num_lost && gap_us <= kMaxGap_us; ++i) {
      packets_.add_refused(held.host_utime,
                           "lost on the way, their beams are not measured; check cable, switch and "
                           "the load of this machine");
    }
  }
  stamp_us_ = packet.stamp_us();
  returns_ = packet.returns();
  packets_.add_good(held.host_utime);
  clock_.set_min_delay(packet.duration_us());
  for (std::size_t column = 0; column < packet.num_columns(); ++column) take_column(held, column);
}

void VelodyneProtocol::take_column(const Held& held, std::size_t column) {
  const Packet& packet = held.packet;
  constexpr int kHalf_cdeg = Packet::kTurn_cdeg / 2;
  const double turned_cdeg = (packet.azimuth_cdeg(column) + kHalf_cdeg) % Packet::kTurn_cdeg;
  const double column_us = now_us_ + Packet::kBlock_us * static_cast<double>(column);
  if (turned_cdeg_ && turned_cdeg < *turned_cdeg_) {
    const double begin_us = column_us - turned_cdeg / packet.rate_cdeg_per_us();
    if (turn_) finish_turn(begin_us, held);
    begin_turn(begin_us, column_us, packet);
  }
  turned_cdeg_ = turned_cdeg;
  if (turn_) add_shots(packet, column, column_us);
}

/// Begins with the first column, which came or was lost, after the head looked straight behind.
void VelodyneProtocol::begin_turn(double begin_us, double column_us, const Packet& packet) {
  begin_us_ = begin_us;
  first_us_ =
      column_us - Packet::kBlock_us * std::floor((column_us - begin_us) / Packet::kBlock_us);
  num_columns_ = 0;
  sum_beams_ = sum_turned_cdeg_ = 0.0;
  const double num_firings = kTurn_cdeg / packet.rate_cdeg_per_us() / Packet::kFiring_us;
  turn_.emplace(plan_, static_cast<std::size_t>(kSlower * num_firings));
}

void VelodyneProtocol::add_shots(const Packet& packet, std::size_t column, double column_us) {
  const auto first =
      static_cast<std::size_t>(std::lround((column_us - first_us_) / Packet::kFiring_us));
  ++num_columns_;
  sum_beams_ += static_cast<double>(first);
  sum_turned_cdeg_ += *turned_cdeg_;
  for (std::size_t firing = 0; firing < 2; ++firing) {
    if (first + firing >= turn_->num_beams()) return;
    for (const std::size_t laser : lasers_) {
      const Packet::Shot shot = packet.shot(column, firing, laser);
      turn_->add(first + firing, laser, level_m_per_unit_[laser] * shot.range, shot.reflectivity);
    }
  }
}

/// Makes a scan of the turn, which ended at `end_us`.
void VelodyneProtocol::finish_turn(double end_us, const Held& held) {
  const double device_us = clock_.arrived(held.packet.stamp_us(), held.host_utime);
  const double turn_us = end_us - begin_us_;
  rate_rpm_ = kMinute_us / turn_us;
  const double expected_us = kTurn_cdeg / held.packet.rate_cdeg_per_us();
  const auto num_columns = static_cast<double>(num_columns_);
  if (turn_us > kSlower * expected_us || kSlower * turn_us < expected_us ||
      Packet::kBlock_us * num_columns < 0.5 * turn_us) {
    return units_.add_refused(held.host_utime, "more than half of a turn is missing");
  }
  const double step_cdeg = kTurn_cdeg * Packet::kFiring_us / turn_us;
  const double first_cdeg = (sum_turned_cdeg_ - step_cdeg * sum_beams_) / num_columns;
  const double shot_cdeg = step_cdeg * mean_shot_us_ / Packet::kFiring_us;
  laser::Scan scan;
  scan.bearing_step_rad = -kCdeg_rad * step_cdeg;
  scan.bearing_min_rad = geometry::kPi - kCdeg_rad * (first_cdeg + shot_cdeg);
  scan.beam_period_us = Packet::kFiring_us;
  scan.range_min_m = kNearest_m;
  turn_->write_to(scan);
  // The last beam may be of the next turn's first column, and then is not measured.
  scan.ranges_m.resize(static_cast<std::size_t>(kTurn_cdeg / step_cdeg));
  scan.intensities.resize(scan.ranges_m.size());
  scan.utime = clock_.host_utime(device_us - (now_us_ - first_us_) + mean_shot_us_);
  is_streaming_ = true;
  trouble_ = {};
  take_scan(std::move(scan), held.host_utime);
}

void VelodyneProtocol::expire(std::int64_t) {
  // Nothing can be asked of it, and a new socket would hear no more.
  deadline_utime_.reset();
  is_streaming_ = false;
  clock_.begin_connection();
  held_.clear();
  stamp_us_.reset();
  forget_turn();
  trouble_ = {Severity::kError,
              "no packet arrives; check power and cable, and on the scanner's own page that it "
              "sends to this machine and to this port"};
}

void VelodyneProtocol::host_clock_stepped(std::int64_t step_us) {
  ScannerSession::host_clock_stepped(step_us);
  packets_.host_clock_stepped();
  for (Held& held : held_) held.host_utime += step_us;
}

Condition VelodyneProtocol::condition() const {
  Condition condition = ScannerSession::condition();
  if (condition.severity != Severity::kError) {
    const std::string warning = packets_.warning("packets");
    if (condition.severity == Severity::kNone && !warning.empty()) condition.text.clear();
    condition.add(Severity::kWarning, warning);
  }
  return condition;
}

ProtocolCounts VelodyneProtocol::counts() const {
  return {units_.counts().num_good, units_.counts().num_bad + packets_.counts().num_bad};
}

std::string VelodyneProtocol::note() const {
  const char* returns = returns_ == Packet::Returns::kStrongest ? "the strongest return"
                        : returns_ == Packet::Returns::kLast    ? "the last return"
                                                                : "the last of two returns";
  return std::to_string(10 * std::lround(rate_rpm_ / 10.0)) + " rpm; " + returns;
}

}  // namespace orchard::device
