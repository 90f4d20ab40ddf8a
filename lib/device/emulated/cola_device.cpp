// SPDX-License-Identifier: BSD-3-Clause
#include "device/emulated/cola_device.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "geometry/angles.hpp"

namespace orchard::device {
namespace {

constexpr double kUnits_per_rad = 10'000.0 * 180.0 / geometry::kPi;
constexpr std::int32_t kAhead = 900'000;
constexpr std::int32_t kFirstShot = -450'000;
constexpr std::size_t kMaxTelegram = 256;

std::int32_t start_angle(const laser::Scan& scan) {
  return static_cast<std::int32_t>(std::lround(scan.bearing_min_rad * kUnits_per_rad)) + kAhead;
}

/// A channel of 16 bits: name, scale, offset, angles, values.
std::string channel(const std::string& name, const laser::Scan& scan,
                    const std::vector<float>& values, double factor) {
  const auto step = std::lround(scan.bearing_step_rad * kUnits_per_rad);
  std::string text =
      fmt::format(" {} 3F800000 00000000 {:X} {:X} {:X}", name,
                  static_cast<std::uint32_t>(start_angle(scan)), step, values.size());
  for (const float value : values) {
    const double scaled = std::isfinite(value) ? factor * static_cast<double>(value) : 0.0;
    text += fmt::format(" {:X}", std::lround(std::clamp(scaled, 0.0, 65535.0)));
  }
  return text;
}

}  // namespace

ColaDevice::ColaDevice(ColaDeviceModel model, EmulatedClock clock)
    : model_(std::move(model)), clock_(clock), sends_intensities_(model_.sends_intensities) {}

void ColaDevice::connected(std::int64_t) {
  half_telegram_.clear();
  to_send_.clear();
}

void ColaDevice::receive(std::string_view bytes, std::int64_t) {
  for (const char c : bytes) {
    if (c == '\x02') {
      half_telegram_.clear();
    } else if (c == '\x03') {
      obey(std::exchange(half_telegram_, {}));
    } else if (half_telegram_.size() < kMaxTelegram) {
      half_telegram_ += c;
    }
  }
}

void ColaDevice::answer(const std::string& telegram) { to_send_ += "\x02" + telegram + "\x03"; }

void ColaDevice::obey(const std::string& telegram) {
  if (telegram == "sEN LMDscandata 1" || telegram == "sEN LMDscandata 0") {
    is_streaming_ = telegram.back() == '1';
    answer(std::string("sEA LMDscandata ") + telegram.back());
  } else if (telegram == "sRN DeviceIdent") {
    answer(fmt::format("sRA DeviceIdent {:X} {} 6 V2.5.0", model_.name.size(), model_.name));
  } else if (telegram == "sRN LMPoutputRange" && last_) {
    const double last_rad = last_->bearing_rad(static_cast<double>(last_->ranges_m.size()) - 1.0);
    const auto stop = static_cast<std::int32_t>(std::lround(last_rad * kUnits_per_rad)) + kAhead;
    answer(fmt::format("sRA LMPoutputRange 1 {:X} {:X} {:X}",
                       std::lround(last_->bearing_step_rad * kUnits_per_rad),
                       static_cast<std::uint32_t>(start_angle(*last_)),
                       static_cast<std::uint32_t>(stop)));
  } else if (telegram == "sMN SetAccessMode 03 F4724744") {
    is_logged_in_ = model_.allows_login;
    answer(is_logged_in_ ? "sAN SetAccessMode 1" : "sAN SetAccessMode 0");
  } else if (telegram.rfind("sWN LMDscandatacfg ", 0) == 0 && is_logged_in_) {
    sends_intensities_ = telegram.rfind("sWN LMDscandatacfg 01 00 1", 0) == 0;
    answer("sWA LMDscandatacfg");
  } else if (telegram == "sMN Run" && is_logged_in_) {
    is_logged_in_ = false;
    answer("sAN Run 1");
  } else {
    answer("sFA 3");
  }
}

void ColaDevice::measured(const device::Measurement& measurement) {
  const auto* scan = std::get_if<laser::Scan>(&measurement);
  if (scan == nullptr || scan->ranges_m.empty()) return;
  const double beam_period_us =
      1e6 / model_.rate_hz * scan->bearing_step_rad / (2.0 * geometry::kPi);
  const double sweep_us = beam_period_us * static_cast<double>(scan->ranges_m.size() - 1);
  sweeps_.push_back(
      {scan->utime + static_cast<std::int64_t>(sweep_us) + kSweepProcessing_us, *scan});
  if (sweeps_.size() > kMaxWaitingSweeps) sweeps_.pop_front();
  last_ = *scan;
}

std::optional<std::int64_t> ColaDevice::deadline() const {
  if (sweeps_.empty()) return std::nullopt;
  return sweeps_.front().complete_utime;
}

void ColaDevice::advance(std::int64_t utime) {
  while (!sweeps_.empty() && sweeps_.front().complete_utime <= utime) {
    if (is_streaming_) send(sweeps_.front());
    sweeps_.pop_front();
  }
}

void ColaDevice::send(const Sweep& sweep) {
  const laser::Scan& scan = sweep.scan;
  const double first_shot_us =
      std::max(0, start_angle(scan) - kFirstShot) / (360.0 * 10'000.0) * 1e6 / model_.rate_hz;
  const auto wrapped = [this](double utime) {
    return static_cast<std::uint32_t>(clock_.ticks(utime, 1.0) & 0xffffffff);
  };
  const bool with_intensities = sends_intensities_ && scan.has_intensities();
  std::string text =
      fmt::format("sSN LMDscandata 1 1 89A27F 0 0 {:X} {:X} {:X} {:X} 0 0 3F 0 0 {:X} 21C 0 {}",
                  num_sent_ & 0xffff, num_sent_ & 0xffff,
                  wrapped(static_cast<double>(scan.utime) - first_shot_us),
                  wrapped(static_cast<double>(sweep.complete_utime)),
                  std::lround(100.0 * model_.rate_hz), with_intensities ? 2 : 1);
  text += channel("DIST1", scan, scan.ranges_m, 1000.0);
  if (with_intensities) text += channel("RSSI1", scan, scan.intensities, 1.0);
  answer(text + " 0 0 0 0 0 0");
  ++num_sent_;
}

}  // namespace orchard::device
