// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "device/emulated/emulated_device.hpp"
#include "laser/scan.hpp"

namespace orchard::device {

/// Model and capabilities of an emulated SICK scanner.
struct ColaDeviceModel {
  std::string name = "TiM561-2050101";
  double rate_hz = 15.0;
  bool allows_login = true;
  bool sends_intensities = false;  ///< without being configured to
};

/// An emulated SICK scanner with CoLa-A (telegram listing 8014631). Its output is the beams of the
/// given scans. The first beam counts as the first shot of a sweep if it points 45 degrees behind
/// the right.
class ColaDevice : public EmulatedDevice {
 public:
  ColaDevice(ColaDeviceModel model, EmulatedClock clock);

  void connected(std::int64_t utime) override;
  void receive(std::string_view bytes, std::int64_t utime) override;
  void measured(const device::Measurement& measurement) override;
  std::optional<std::int64_t> deadline() const override;
  void advance(std::int64_t utime) override;

  std::int64_t num_sent() const { return num_sent_; }

 private:
  struct Sweep {
    std::int64_t complete_utime = 0;
    laser::Scan scan;
  };

  void answer(const std::string& telegram);
  void obey(const std::string& telegram);
  void send(const Sweep& sweep);

  ColaDeviceModel model_;
  EmulatedClock clock_;
  std::string half_telegram_;
  bool is_streaming_ = false;
  bool is_logged_in_ = false;
  bool sends_intensities_ = false;
  std::deque<Sweep> sweeps_;
  std::optional<laser::Scan> last_;  ///< for the range of angles
  std::int64_t num_sent_ = 0;
};

}  // namespace orchard::device
