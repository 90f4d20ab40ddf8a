// SPDX-License-Identifier: BSD-3-Clause
#include "device/emulated/controller_device.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <variant>

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

}  // namespace orchard::device
