// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "device/drivers_config.hpp"
#include "device/emulated/emulated_device.hpp"
#include "laser/scan.hpp"

namespace orchard::device {

/// Common base of the emulated scanners: sends each sweep when it is complete, if the host has
/// asked for them.
class EmulatedScanner : public EmulatedDevice {
 public:
  std::optional<std::int64_t> deadline() const override;
  void advance(std::int64_t utime) override;

  /// Number of sweeps sent, for tests.
  std::int64_t num_sent() const { return num_sent_; }

 protected:
  struct Sweep {
    std::int64_t complete_utime = 0;
    std::uint64_t ticks = 0;  ///< of the clock at step 0 (SCIP)
    laser::Scan scan;
  };
  explicit EmulatedScanner(EmulatedClock clock) : clock_(clock) {}
  void add(Sweep sweep);
  virtual bool is_streaming() const = 0;
  virtual void send(const Sweep& sweep) = 0;

  EmulatedClock clock_;
  std::int64_t num_sent_ = 0;

 private:
  std::deque<Sweep> sweeps_;
};

/// Model and capabilities of an emulated SICK scanner.
struct ColaDeviceModel {
  std::string name = "TiM561-2050101";
  double rate_hz = 15.0;
  bool allows_login = true;
  bool sends_intensities = false;  ///< without being configured to
  bool is_binary = false;          ///< speaks CoLa-B, and answers nothing else
  /// "Time since start up" is that of the end of the sweep, as of a real TiM781S and LMS111.
  bool stamps_end = false;
  unsigned state = 0;  ///< second field of the device status: 1 error, 2 dirty front screen
};

/// An emulated SICK scanner with CoLa-A or CoLa-B (telegram listing 8014631). Its output is the
/// beams of the given scans. The first beam counts as the first shot of a sweep if it points 45
/// degrees behind the right.
class ColaDevice : public EmulatedScanner {
 public:
  ColaDevice(ColaDeviceModel model, EmulatedClock clock);

  void connected(std::int64_t utime) override;
  void receive(std::string_view bytes, std::int64_t utime) override;
  void measured(const device::Measurement& measurement) override;

  /// Changes the second field of the device status.
  void set_state(unsigned state) { model_.state = state; }

 private:
  class Telegram;
  void receive_text(char byte);
  void receive_binary(char byte);
  void answer(const Telegram& telegram);
  void obey(const std::string& telegram);
  void refuse();
  bool is_streaming() const override { return is_streaming_; }
  void send(const Sweep& sweep) override;

  ColaDeviceModel model_;
  std::string half_telegram_;
  bool is_streaming_ = false;
  bool is_logged_in_ = false;
  bool sends_intensities_ = false;
  std::optional<laser::Scan> last_;  ///< for the range of angles
};

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
class ScipDevice : public EmulatedScanner {
 public:
  ScipDevice(ScipModel model, EmulatedClock clock);

  void connected(std::int64_t utime) override;
  void receive(std::string_view bytes, std::int64_t utime) override;
  void measured(const device::Measurement& measurement) override;

  /// Stops the sweeps and refuses them with this status (specification, 8.1): "10" while it gets
  /// ready, "50" with a fault of its motor; "00" ends that.
  void set_status(const std::string& status);

 private:
  void obey(const std::string& command, std::int64_t utime);
  void answer(const std::string& command, const std::string& status, const std::string& body = {});
  void obey_stream(const std::string& command);
  void describe(const std::string& command);
  bool is_streaming() const override { return !stream_.empty(); }
  void send(const Sweep& sweep) override;

  ScipModel model_;
  std::string half_command_;
  std::string stream_;  ///< the active stream command; empty: none
  std::string status_ = "00";
  bool is_in_clock_mode_ = false;
};

/// Makes an emulated scanner with `protocol`, powered up at `start_utime`. It takes its angles,
/// ranges and rate from the first scans that it is given.
std::unique_ptr<EmulatedDevice> make_emulated_laser(device::LaserProtocol protocol,
                                                    std::int64_t start_utime);

}  // namespace orchard::device
