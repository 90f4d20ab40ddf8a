// SPDX-License-Identifier: BSD-3-Clause
#include "device/emulated/emulated_laser.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include "device/emulated/cola_device.hpp"
#include "device/emulated/scip_device.hpp"
#include "geometry/angles.hpp"

namespace orchard::device {
namespace {

/// Clock skew: the difference between two good crystals.
constexpr double kSkew = 40e-6;

/// A scanner whose model is taken from its first scans; it does not answer before them.
class LikeItsScans : public EmulatedDevice {
 public:
  LikeItsScans(device::LaserProtocol protocol, EmulatedClock clock)
      : protocol_(protocol), clock_(clock) {}

  void connected(std::int64_t utime) override {
    if (device_) device_->connected(utime);
  }
  void receive(std::string_view bytes, std::int64_t utime) override {
    if (device_) device_->receive(bytes, utime);
  }
  void measured(const device::Measurement& measurement) override {
    if (const auto* scan = std::get_if<laser::Scan>(&measurement); scan != nullptr && !device_) {
      learn(*scan);
    }
    if (device_) device_->measured(measurement);
  }
  std::optional<std::int64_t> deadline() const override {
    return device_ ? device_->deadline() : std::nullopt;
  }
  void advance(std::int64_t utime) override {
    if (!device_) return;
    device_->advance(utime);
    to_send_ += device_->take_to_send();
  }

 private:
  void learn(const laser::Scan& scan) {
    if (scan.ranges_m.size() < 2 || scan.bearing_step_rad == 0.0) return;
    double turn_us = scan.beam_period_us * 2.0 * geometry::kPi / std::abs(scan.bearing_step_rad);
    if (turn_us <= 0.0 && first_utime_) turn_us = static_cast<double>(scan.utime - *first_utime_);
    first_utime_ = scan.utime;
    if (turn_us < 1e3 || turn_us > 1e6) return;
    if (protocol_ == device::LaserProtocol::kColaA) {
      ColaDeviceModel model;
      model.name = "emulated";
      model.rate_hz = 1e6 / turn_us;
      device_ = std::make_unique<ColaDevice>(model, clock_);
    } else {
      device_ = std::make_unique<ScipDevice>(scip_model_like(scan, 1e6 / turn_us), clock_);
    }
  }

  device::LaserProtocol protocol_;
  EmulatedClock clock_;
  std::optional<std::int64_t> first_utime_;
  std::unique_ptr<EmulatedDevice> device_;
};

}  // namespace

std::unique_ptr<EmulatedDevice> make_emulated_laser(device::LaserProtocol protocol,
                                                    std::int64_t start_utime) {
  return std::make_unique<LikeItsScans>(protocol, EmulatedClock{start_utime, kSkew});
}

}  // namespace orchard::device
