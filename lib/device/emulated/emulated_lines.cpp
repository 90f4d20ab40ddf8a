// SPDX-License-Identifier: BSD-3-Clause
#include "device/emulated/emulated_lines.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <variant>

#include "geometry/angles.hpp"

namespace orchard::device {
namespace {

constexpr std::size_t kMaxUnsent_bytes = 4096;  // a small controller's buffer

std::string text_of(const pose::Odometry& odometry) {
  std::array<char, 100> text{};
  const int size = std::snprintf(text.data(), text.size(), "V %.9g %.9g", odometry.speed_mps,
                                 odometry.yaw_rate_radps);
  if (odometry.covariance[0] > 0.0 && odometry.covariance[2] > 0.0) {
    std::snprintf(text.data() + size, text.size() - static_cast<std::size_t>(size), " %.9g %.9g",
                  std::sqrt(odometry.covariance[0]), std::sqrt(odometry.covariance[2]));
  }
  return text.data();
}

std::string text_of(const pose::Imu& imu) {
  std::array<char, 160> text{};
  const auto& rate = imu.angular_rate_radps;
  const auto& force = imu.acceleration_mps2;
  std::snprintf(text.data(), text.size(), "I %.9g %.9g %.9g %.9g %.9g %.9g", rate[0], rate[1],
                rate[2], force[0], force[1], force[2]);
  return text.data();
}

constexpr std::size_t kLongestRequest_bytes = 1024;

bool is_leap(int year) { return (year % 4 == 0 && year % 100 != 0) || year % 400 == 0; }

/// Formats a time as "2026-05-04T10:11:12.250000Z", by counting years and months.
std::string utc_text(std::int64_t utime) {
  constexpr std::array<int, 12> kDays{31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  std::int64_t days = utime / 86'400'000'000;
  const std::int64_t of_day_us = utime % 86'400'000'000;
  int year = 1970;
  for (; days >= (is_leap(year) ? 366 : 365); ++year) days -= is_leap(year) ? 366 : 365;
  std::size_t month = 0;
  for (;; ++month) {
    const int length = kDays[month] + (month == 1 && is_leap(year) ? 1 : 0);
    if (days < length) break;
    days -= length;
  }
  const auto second = static_cast<int>(of_day_us / 1'000'000);
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02d-%02dT%02d:%02d:%02d.%06dZ", year,
                static_cast<int>(month) + 1, static_cast<int>(days) + 1, second / 3600,
                second / 60 % 60, second % 60, static_cast<int>(of_day_us % 1'000'000));
  return text.data();
}

/// Converts an NMEA quality to gpsd's status.
int status_of(std::int8_t quality) {
  constexpr std::array<int, 10> kStatus{0, 1, 2, 9, 3, 4, 5, 7, 8, 1};
  return kStatus[static_cast<std::size_t>(quality) % kStatus.size()];
}

/// The GST report with the error ellipse; empty when the covariance is unknown.
std::string noise_report(const pose::Gnss& gnss, const std::string& time) {
  const auto& covariance = gnss.covariance;
  if (covariance[0] <= 0.0) return {};
  const double mean = (covariance[0] + covariance[3]) / 2.0;
  const double half = (covariance[3] - covariance[0]) / 2.0;
  const double radius = std::hypot(half, covariance[1]);
  const double orientation_deg = std::atan2(covariance[1], half) * 90.0 / geometry::kPi;
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(),
                "{\"class\":\"GST\",\"device\":\"emulated\",\"time\":\"%s\",\"major\":%.6f,"
                "\"minor\":%.6f,\"orient\":%.6f,\"lat\":%.6f,\"lon\":%.6f,\"alt\":%.6f}\r\n",
                time.c_str(), std::sqrt(mean + radius), std::sqrt(std::fmax(mean - radius, 0.0)),
                orientation_deg, std::sqrt(covariance[3]), std::sqrt(covariance[0]),
                std::sqrt(covariance[5]));
  return text.data();
}

std::string fix_report(const pose::Gnss& gnss, const std::string& time) {
  std::array<char, 400> text{};
  if (gnss.fix_quality == 0) {
    return "{\"class\":\"TPV\",\"device\":\"emulated\",\"mode\":1,\"time\":\"" + time + "\"}\r\n";
  }
  std::snprintf(text.data(), text.size(),
                "{\"class\":\"TPV\",\"device\":\"emulated\",\"status\":%d,\"mode\":3,\"time\":"
                "\"%s\",\"lat\":%.10f,\"lon\":%.10f,\"altHAE\":%.4f}\r\n",
                status_of(gnss.fix_quality), time.c_str(), gnss.latitude_deg, gnss.longitude_deg,
                gnss.altitude_m);
  return text.data();
}

}  // namespace

void ControllerDevice::measured(const device::Measurement& measurement) {
  std::string line;
  std::int64_t utime = 0;
  if (const auto* odometry = std::get_if<pose::Odometry>(&measurement)) {
    line = text_of(*odometry);
    utime = odometry->utime;
  } else if (const auto* imu = std::get_if<pose::Imu>(&measurement)) {
    line = text_of(*imu);
    utime = imu->utime;
  } else {
    return;
  }
  const auto time_us = static_cast<std::uint32_t>(clock_.ticks(static_cast<double>(utime), 1.0));
  line += " @" + std::to_string(time_us);
  unsigned sum = 0;
  for (const char byte : line) sum ^= static_cast<unsigned char>(byte);
  std::array<char, 8> end{};
  std::snprintf(end.data(), end.size(), "*%02X\r\n", sum);
  if (to_send_.size() < kMaxUnsent_bytes) to_send_ += line + end.data();
}

void GpsdDevice::connected(std::int64_t) {
  asked_.clear();
  is_watched_ = false;
  to_send_ = "{\"class\":\"VERSION\",\"release\":\"emulated\",\"proto_major\":3}\r\n";
}

void GpsdDevice::receive(std::string_view bytes, std::int64_t) {
  asked_ += bytes;
  for (std::size_t end = 0; (end = asked_.find('\n')) != std::string::npos;
       asked_.erase(0, end + 1)) {
    is_watched_ = is_watched_ || asked_.compare(0, 6, "?WATCH") == 0;
    to_send_ +=
        "{\"class\":\"DEVICES\",\"devices\":[{\"class\":\"DEVICE\",\"path\":\"emulated\"}]}\r\n";
  }
  if (asked_.size() > kLongestRequest_bytes) asked_.clear();
}

void GpsdDevice::measured(const device::Measurement& measurement) {
  if (const auto* gnss = std::get_if<pose::Gnss>(&measurement)) on_their_way_.push_back(*gnss);
}

std::optional<std::int64_t> GpsdDevice::deadline() const {
  if (on_their_way_.empty()) return std::nullopt;
  return on_their_way_.front().utime + latency_us_;
}

void GpsdDevice::advance(std::int64_t utime) {
  while (!on_their_way_.empty() && on_their_way_.front().utime + latency_us_ <= utime) {
    const pose::Gnss gnss = on_their_way_.front();
    on_their_way_.pop_front();
    const std::string time = utc_text(gnss.utime);
    if (is_watched_) to_send_ += noise_report(gnss, time) + fix_report(gnss, time);
  }
}

}  // namespace orchard::device
