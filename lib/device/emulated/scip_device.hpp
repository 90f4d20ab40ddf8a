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

/// Parameters and capabilities of an emulated Hokuyo scanner.
struct ScipModel {
  std::string name = "UST-10LX";
  int range_min_mm = 20;
  int range_max_mm = 30000;
  int steps_per_turn = 1440;
  int first_step = 0;
  int last_step = 1080;
  int front_step = 540;
  int rate_rpm = 2400;
  std::uint32_t no_return = 65533;  ///< sent for a beam without return
  bool has_intensities = true;      ///< supports ME
  bool has_clock_mode = true;       ///< supports TM
};

ScipModel ust_10lx();
ScipModel utm_30lx();
ScipModel urg_04lx_ug01();

/// A model with the beams of a scan, exact where its step divides a turn; `rate_hz` is the motor
/// speed.
ScipModel scip_model_like(const laser::Scan& scan, double rate_hz);

/// An emulated Hokuyo scanner: answers commands by the SCIP 2.0 specification (C-42-03320B) and, on
/// request, sends each sweep right after its last beam.
class ScipDevice : public EmulatedDevice {
 public:
  ScipDevice(ScipModel model, EmulatedClock clock);

  void connected(std::int64_t utime) override;
  void receive(std::string_view bytes, std::int64_t utime) override;
  void measured(const device::Measurement& measurement) override;
  std::optional<std::int64_t> deadline() const override;
  void advance(std::int64_t utime) override;

  /// Number of sweeps sent, for tests.
  std::int64_t num_sent() const { return num_sent_; }

 private:
  struct Sweep {
    std::int64_t complete_utime = 0;
    std::uint64_t ticks = 0;  ///< of the clock at step 0
    laser::Scan scan;
  };

  void obey(const std::string& command, std::int64_t utime);
  void answer(const std::string& command, const std::string& status, const std::string& body = {});
  void obey_stream(const std::string& command);
  void describe(const std::string& command);
  void send(const Sweep& sweep);

  ScipModel model_;
  EmulatedClock clock_;
  std::string half_command_;
  std::string stream_;  ///< the active stream command; empty: none
  bool is_in_clock_mode_ = false;
  std::deque<Sweep> sweeps_;
  std::int64_t num_sent_ = 0;
};

}  // namespace orchard::device
