// SPDX-License-Identifier: BSD-3-Clause
// What goes wrong with a device, on an emulated one in simulated time: the level and the text that
// STATUS has, and after how many seconds. Prints a table.
#include <gtest/gtest.h>

#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <string>

#include "device/cola/cola_protocol.hpp"
#include "device/emulated/emulated_laser.hpp"
#include "device/gnss/gpsd_protocol.hpp"
#include "device/lines/controller_protocol.hpp"
#include "device/scip/scip_protocol.hpp"
#include "unit/device/simulated_line.hpp"

namespace orchard::device {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::int64_t kNoon = 1'700'000'000'000'000;
constexpr std::int64_t kPeriod_us = 100'000;  // ten sweeps a second
constexpr std::int64_t kHealthy_us = 5'000'000;

/// What is expected of a fault.
struct Expected {
  const char* name;
  Severity severity;
  std::string text;    ///< that STATUS contains
  double max_s = 0.0;  ///< until it is said
};

void print_row(const Expected& fault, double seconds, const Condition& condition) {
  constexpr const char* kLevels[] = {"OK", "WAITING", "WARNING", "ERROR"};
  std::printf("| %s | %s | %s | %.1f |\n", fault.name,
              kLevels[static_cast<int>(condition.severity)], condition.text.c_str(), seconds);
}

laser::Scan scan_of(std::int64_t utime) {
  laser::Scan scan;
  scan.utime = utime;
  scan.bearing_min_rad = -135.0 * kPi / 180.0;
  scan.bearing_step_rad = 0.25 * kPi / 180.0;
  scan.ranges_m.assign(1081, 2.0f);
  scan.intensities.assign(1081, 500.0f);
  return scan;
}

/// A scanner on a line: sweeps at a steady rate.
struct Scanner {
  Scanner(Protocol& protocol, EmulatedDevice& device)
      : protocol(protocol), device(device), line(protocol, device, kNoon, 1) {
    device.measured(scan_of(kNoon - kPeriod_us));
    line.connect();
  }

  void run(std::int64_t duration_us) {
    for (const std::int64_t end = line.utime() + duration_us; line.utime() < end;) step();
  }

  void step() {
    line.run_until(line.utime() + kPeriod_us);
    if (is_measuring) device.measured(scan_of(line.utime()));
    for (const Measurement& m : protocol.take_measurements()) {
      ++num_scans;
      has_intensities = !std::get<laser::Scan>(m).intensities.empty();
    }
  }

  /// From now on until the fault is said.
  void expect(const Expected& fault) {
    const std::int64_t begin = line.utime();
    Condition said = protocol.condition();
    while (line.utime() < begin + 30'000'000) {
      if (said.severity == fault.severity && said.text.find(fault.text) != std::string::npos) break;
      step();
      said = protocol.condition();
    }
    const double seconds = 1e-6 * static_cast<double>(line.utime() - begin);
    EXPECT_EQ(said.severity, fault.severity) << fault.name << ": " << said.text;
    EXPECT_NE(said.text.find(fault.text), std::string::npos) << fault.name << ": " << said.text;
    EXPECT_LE(seconds, fault.max_s) << fault.name;
    print_row(fault, seconds, said);
  }

  void expect_healthy() {
    run(kHealthy_us);
    EXPECT_EQ(protocol.condition().severity, Severity::kNone) << protocol.condition().text;
    EXPECT_GT(num_scans, 20);
  }

  Protocol& protocol;
  EmulatedDevice& device;
  SimulatedLine line;
  bool is_measuring = true;
  int num_scans = 0;
  bool has_intensities = false;
};

ScipModel hokuyo_model() {
  ScipModel model = ust_10lx();
  model.rate_rpm = 600;
  return model;
}

struct Hokuyo {
  ScipProtocol protocol;
  ScipDevice device{hokuyo_model(), {kNoon - 60'000'000, 0.0}};
  Scanner scanner{protocol, device};
};

ColaDeviceModel sick_model(bool is_binary) {
  ColaDeviceModel model;
  model.rate_hz = 10.0;
  model.is_binary = is_binary;
  return model;
}

struct Sick {
  explicit Sick(bool is_binary = true)
      : device(sick_model(is_binary), {kNoon - 60'000'000, 0.0}), scanner(protocol, device) {}
  ColaProtocol protocol;
  ColaDevice device;
  Scanner scanner;
};

/// Changes a bit of that share of what the device sends.
std::function<void(std::string&)> damage(double share) {
  return [share, random = std::make_shared<std::mt19937>(7)](std::string& bytes) {
    if (std::bernoulli_distribution(share)(*random)) bytes[bytes.size() / 2] ^= 1;
  };
}

TEST(Faults, RefusedSweepsAreAWarningWithTheirReason) {
  Hokuyo hokuyo;
  hokuyo.scanner.expect_healthy();
  hokuyo.scanner.line.spoil = damage(0.7);
  hokuyo.scanner.expect({"Hokuyo: 70 % of the sweeps damaged", Severity::kWarning,
                         "refused in 10 s: a wrong checksum", 1.0});
  hokuyo.scanner.line.spoil = nullptr;
  hokuyo.scanner.run(11'000'000);
  EXPECT_EQ(hokuyo.protocol.condition().severity, Severity::kNone);
  hokuyo.scanner.line.spoil = damage(0.05);
  hokuyo.scanner.expect({"Hokuyo: 5 % of the sweeps damaged", Severity::kWarning,
                         "refused in 10 s: a wrong checksum", 11.0});

  Sick sick;
  sick.scanner.expect_healthy();
  sick.scanner.line.spoil = damage(0.7);
  sick.scanner.expect({"SICK: 70 % of the sweeps damaged", Severity::kWarning,
                       "refused in 10 s: a telegram that is cut off or has a wrong checksum", 1.0});
}

TEST(Faults, AllSweepsRefusedIsAnError) {
  Hokuyo hokuyo;
  hokuyo.scanner.expect_healthy();
  hokuyo.scanner.line.spoil = damage(1.0);
  hokuyo.scanner.expect(
      {"Hokuyo: all sweeps damaged", Severity::kError, "refused in 10 s: a wrong checksum", 2.0});
}

TEST(Faults, AScannersOwnFaultIsAnError) {
  Hokuyo hokuyo;
  hokuyo.scanner.expect_healthy();
  hokuyo.device.set_status("50");
  hokuyo.scanner.expect({"Hokuyo: status 50, motor or laser", Severity::kError,
                         "status 50: hardware fault (laser, motor)", 0.2});
  hokuyo.device.set_status("00");
  hokuyo.scanner.run(10'000'000);
  hokuyo.scanner.expect_healthy();

  Sick sick;
  sick.scanner.expect_healthy();
  sick.device.set_state(1);
  sick.scanner.expect({"SICK: internal error", Severity::kError, "internal error", 0.3});
  sick.device.set_state(2);
  sick.scanner.expect({"SICK: dirty front screen", Severity::kWarning, "dirty front screen", 0.3});
  sick.device.set_state(0);
  sick.scanner.run(10'000'000);
  sick.scanner.expect_healthy();
}

TEST(Faults, SilenceIsAnError) {
  Hokuyo hokuyo;
  hokuyo.scanner.expect_healthy();
  hokuyo.scanner.is_measuring = false;
  hokuyo.scanner.expect(
      {"Hokuyo: no sweeps any more", Severity::kError, "the scanner sends no scans", 1.2});
  Sick sick;
  sick.scanner.expect_healthy();
  sick.scanner.is_measuring = false;
  sick.scanner.expect(
      {"SICK: no sweeps any more", Severity::kError, "the scanner sends no scans", 1.2});
}

TEST(Faults, AScannerThatGetsReadyIsWaitedForAndKeepsItsIntensities) {
  ScipProtocol protocol;
  ScipDevice device(hokuyo_model(), {kNoon, 0.0});
  device.set_status("10");
  Scanner scanner(protocol, device);
  scanner.expect({"Hokuyo: getting ready", Severity::kWaiting,
                  "not ready for ME0000108000000: status 10", 0.5});
  scanner.run(3'000'000);
  device.set_status("00");
  scanner.expect_healthy();
  EXPECT_TRUE(scanner.has_intensities);
}

TEST(Faults, WhoAnswersNothingIsAnErrorThatSaysWhatToCheck) {
  ScipProtocol protocol;
  ColaDevice other(sick_model(true), {kNoon, 0.0});
  Scanner scanner(protocol, other);
  scanner.expect({"SCIP asked of another device", Severity::kError,
                  "no answer to QT; check that it is a scanner with SCIP 2.0", 2.0});
  ColaProtocol cola;
  ScipDevice hokuyo(hokuyo_model(), {kNoon, 0.0});
  Scanner none(cola, hokuyo);
  none.expect({"CoLa asked of another device", Severity::kError, "in CoLa-A and CoLa-B", 3.5});
}

TEST(Faults, OfAControllerAndOfGpsd) {
  ControllerProtocol lines{OdometryDriverConfig{}, ImuDriverConfig{}};
  lines.connected(kNoon);
  EXPECT_EQ(lines.condition().severity, Severity::kWaiting);
  for (int i = 0; i < 100; ++i) lines.receive("\nV 1 0\n", kNoon + i * 20'000);
  EXPECT_EQ(lines.condition().severity, Severity::kNone);
  for (int i = 100; i < 110; ++i) lines.receive("V 1 ?\nV 1 0\n", kNoon + i * 20'000);
  EXPECT_EQ(lines.condition().severity, Severity::kWarning);
  print_row({"controller: every second line wrong", Severity::kWarning, "", 0.0}, 0.2,
            lines.condition());
  const std::int64_t silent = *lines.deadline();
  lines.expire(silent);
  EXPECT_EQ(lines.condition().severity, Severity::kError);
  print_row({"controller: silent", Severity::kError, "", 0.0}, 1.0, lines.condition());

  GpsdProtocol gpsd{GnssDriverConfig{}};
  gpsd.connected(kNoon);
  EXPECT_EQ(gpsd.condition().severity, Severity::kWaiting);
  gpsd.receive("{\"class\":\"DEVICES\",\"devices\":[]}\n", kNoon);
  EXPECT_EQ(gpsd.condition().severity, Severity::kError);
  print_row({"gpsd: without a receiver", Severity::kError, "", 0.0}, 0.0, gpsd.condition());
  gpsd.receive("{\"class\":\"TPV\",\"mode\":1}\n", kNoon);
  EXPECT_EQ(gpsd.condition().severity, Severity::kWaiting);
  gpsd.receive(
      "{\"class\":\"TPV\",\"mode\":2,\"time\":\"2026-05-04T10:11:13Z\",\"lat\":1,\"lon\":2}\n",
      kNoon + 1000);
  EXPECT_EQ(gpsd.condition().severity, Severity::kNone) << gpsd.condition().text;
  gpsd.receive("{\"class\":\"TPV\",\"mode\":1}\n", kNoon + 2000);
  EXPECT_EQ(gpsd.condition().severity, Severity::kWarning);
  print_row({"gpsd: fix lost", Severity::kWarning, "", 0.0}, 0.0, gpsd.condition());
}

}  // namespace
}  // namespace orchard::device
