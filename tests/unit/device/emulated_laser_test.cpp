// SPDX-License-Identifier: BSD-3-Clause
// Emulated scanners and the protocols that read them, with a line between, in simulated time. The
// truth is the scans that were handed to the emulator.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <random>
#include <string>

#include "device/cola/cola_protocol.hpp"
#include "device/emulated/emulated_laser.hpp"
#include "device/laser_protocol.hpp"
#include "device/scip/scip_protocol.hpp"
#include "unit/device/simulated_line.hpp"

namespace orchard::device {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::int64_t kNoon = 1'700'000'000'000'000;

/// A sweep of ranges that only one sweep has: whole millimetres, some without return.
laser::Scan sweep_of(const laser::Scan& geometry, std::int64_t utime, int index) {
  laser::Scan scan = geometry;
  scan.utime = utime;
  std::mt19937 random(static_cast<unsigned>(index));
  for (float& range_m : scan.ranges_m) {
    const unsigned mm = 500 + random() % 3000;
    range_m = random() % 20 == 0 ? 0.0f : static_cast<float>(1e-3 * mm);
  }
  if (!scan.intensities.empty()) {
    for (float& intensity : scan.intensities) intensity = static_cast<float>(random() % 4000);
  }
  return scan;
}

/// What a Hokuyo scanner measures, by its data sheet: steps of a turn, the first and last measured
/// one, the one ahead.
laser::Scan hokuyo_geometry(int steps, int first, int last, int ahead, double turn_us) {
  laser::Scan scan;
  scan.bearing_min_rad = (first - ahead) * 2 * kPi / steps;
  scan.bearing_step_rad = 2 * kPi / steps;
  scan.beam_period_us = turn_us / steps;
  scan.ranges_m.resize(static_cast<std::size_t>(last - first + 1));
  return scan;
}

struct Outcome {
  std::vector<double> errors_us;  ///< stamps less the truth
  std::int64_t num_measured = 0;
  std::int64_t num_wrong = 0;  ///< sweeps unlike any that was measured
};

/// Drives sweeps through the line and holds what comes out against them.
Outcome run(Protocol& protocol, device::EmulatedDevice& device, SimulatedLine& line,
            const laser::Scan& geometry, double period_us, int num_sweeps) {
  Outcome outcome;
  std::deque<laser::Scan> measured;
  const std::int64_t begin = line.utime();
  for (int i = 0; i < num_sweeps; ++i) {
    const auto utime = begin + static_cast<std::int64_t>(std::llround(i * period_us));
    line.run_until(utime);
    const laser::Scan truth = sweep_of(geometry, utime, i);
    measured.push_back(truth);
    if (measured.size() > 50) measured.pop_front();
    device.measured(truth);
    ++outcome.num_measured;
    for (const Measurement& m : protocol.take_measurements()) {
      const auto& scan = std::get<laser::Scan>(m);
      const auto found = std::find_if(measured.begin(), measured.end(), [&](const laser::Scan& s) {
        return s.ranges_m == scan.ranges_m;
      });
      if (found == measured.end()) {
        ++outcome.num_wrong;
        continue;
      }
      const laser::Scan& source = *found;
      if (!source.intensities.empty() && scan.intensities != source.intensities) {
        ++outcome.num_wrong;
      }
      for (std::size_t b = 0; b < scan.ranges_m.size(); b += 30) {
        const auto beam = static_cast<double>(b);
        EXPECT_NEAR(scan.bearing_rad(beam), source.bearing_rad(beam), 1e-9);
      }
      EXPECT_NEAR(scan.beam_period_us, source.beam_period_us, 1e-6);
      outcome.errors_us.push_back(static_cast<double>(scan.utime - source.utime));
    }
  }
  return outcome;
}

double worst(const std::vector<double>& errors_us) {
  double worst_us = 0.0;
  for (const double error : errors_us) worst_us = std::max(worst_us, std::abs(error));
  return worst_us;
}

double sd(const std::vector<double>& errors_us) {
  double mean = 0.0;
  double squares = 0.0;
  const auto n = static_cast<double>(errors_us.size());
  for (const double error : errors_us) mean += error / n;
  for (const double error : errors_us) squares += (error - mean) * (error - mean) / n;
  return std::sqrt(squares);
}

struct Model {
  const char* name;
  device::ScipModel model;
  laser::Scan geometry;
  double period_us;
};

/// By the data sheets: URG-04LX-UG01 240 degrees in 1024ths of a turn, 10 Hz; the others 270
/// degrees in quarters of one, 40 Hz.
std::vector<Model> hokuyos() {
  std::vector<Model> models = {
      {"URG-04LX-UG01", device::urg_04lx_ug01(), hokuyo_geometry(1024, 44, 725, 384, 100e3), 100e3},
      {"UTM-30LX", device::utm_30lx(), hokuyo_geometry(1440, 0, 1080, 540, 25e3), 25e3},
      {"UST-10LX", device::ust_10lx(), hokuyo_geometry(1440, 0, 1080, 540, 25e3), 25e3}};
  models.back().geometry.intensities.resize(1081);
  return models;
}

TEST(EmulatedHokuyo, EverySweepComesWithItsRangesBearingsAndTime) {
  for (const Model& m : hokuyos()) {
    ScipProtocol scip;
    device::ScipDevice device(m.model, {kNoon - 77'000'000, 50e-6});
    SimulatedLine line(scip, device, kNoon, 1);
    line.connect();
    line.run_until(kNoon + 500'000);
    const Outcome outcome = run(scip, device, line, m.geometry, m.period_us, 200);
    EXPECT_EQ(outcome.num_wrong, 0) << m.name;
    EXPECT_GE(static_cast<int>(outcome.errors_us.size()), 197) << m.name;
    EXPECT_LT(worst(outcome.errors_us), 1500.0) << m.name;
    EXPECT_EQ(scip.counts().num_bad, 0) << m.name;
    EXPECT_EQ(scip.condition().text, "") << m.name;
  }
}

// Ten minutes at 40 Hz, in which the clock wraps, on a host under load.
TEST(EmulatedHokuyo, StampsStayRightThroughTheWrapOfTheClockUnderLoad) {
  const Model m = hokuyos()[2];
  ScipProtocol scip;
  const auto wrap_us = std::int64_t{1} << 24;
  device::ScipDevice device(m.model, {kNoon - wrap_us * 1000 + 300'000'000, -120e-6});
  SimulatedLine line(scip, device, kNoon, 2);
  line.jitter_us = 3000.0;
  line.held_up_probability = 0.02;
  line.connect();
  line.run_until(kNoon + 500'000);
  const Outcome outcome = run(scip, device, line, m.geometry, m.period_us, 24'000);
  EXPECT_EQ(outcome.num_wrong, 0);
  EXPECT_GE(static_cast<int>(outcome.errors_us.size()), 23'990);
  EXPECT_LT(worst(outcome.errors_us), 4000.0);
  EXPECT_LT(sd(outcome.errors_us), 700.0);
  RecordProperty("worst_us", static_cast<int>(worst(outcome.errors_us)));
  RecordProperty("sd_us", static_cast<int>(sd(outcome.errors_us)));
}

TEST(EmulatedHokuyo, OfBrokenSweepsNoBeamIsPublished) {
  const Model m = hokuyos()[0];
  ScipProtocol scip;
  device::ScipDevice device(m.model, {kNoon - 77'000'000, 0.0});
  SimulatedLine line(scip, device, kNoon, 3);
  line.connect();
  line.run_until(kNoon + 500'000);
  std::mt19937 random(5);
  int num_spoilt = 0;
  line.spoil = [&](std::string& bytes) {
    if (random() % 100 != 0) return;
    ++num_spoilt;
    bytes[random() % bytes.size()] ^= static_cast<char>(1 << (random() % 8));
  };
  const Outcome outcome = run(scip, device, line, m.geometry, m.period_us, 5000);
  EXPECT_GT(num_spoilt, 20);
  EXPECT_EQ(outcome.num_wrong, 0);
  // A broken line end may take the sweep after it along.
  EXPECT_GE(static_cast<int>(outcome.errors_us.size()), 4997 - 2 * num_spoilt);
  EXPECT_GE(scip.counts().num_bad, num_spoilt / 2);
}

TEST(EmulatedHokuyo, AScannerThatWasSwitchedOffIsFollowed) {
  const Model m = hokuyos()[2];
  ScipProtocol scip;
  for (int i = 0; i < 3; ++i) {
    const std::int64_t now = kNoon + i * 60'000'000;
    device::ScipDevice device(m.model, {now - 3'000'000, 0.0});
    SimulatedLine line(scip, device, now, 4);
    line.connect();
    line.run_until(now + 500'000);
    const Outcome outcome = run(scip, device, line, m.geometry, m.period_us, 100);
    EXPECT_EQ(outcome.num_wrong, 0);
    EXPECT_GE(static_cast<int>(outcome.errors_us.size()), 97);
    EXPECT_LT(worst(outcome.errors_us), 1500.0) << i;
  }
  EXPECT_EQ(scip.clock().num_restarts(), 2);
}

TEST(EmulatedHokuyo, LikeAScanHasTheScansBeams) {
  laser::Scan scan = hokuyo_geometry(720, 180, 540, 360, 100e3);  // 180 degrees in halves, ahead
  scan.range_min_m = 0.1;
  scan.range_max_m = 30.0;
  ScipProtocol scip;
  device::ScipDevice device(device::scip_model_like(scan, 10.0), {kNoon - 1'000'000, 0.0});
  SimulatedLine line(scip, device, kNoon, 1);
  line.connect();
  line.run_until(kNoon + 500'000);
  const Outcome outcome = run(scip, device, line, scan, 100e3, 50);
  EXPECT_EQ(outcome.num_wrong, 0);
  EXPECT_GE(static_cast<int>(outcome.errors_us.size()), 47);
}

/// 270 degrees in thirds or quarters of a degree, from 45 degrees behind the right.
laser::Scan sick_geometry(int num_beams, double step_deg, double rate_hz) {
  laser::Scan scan;
  scan.bearing_min_rad = -135.0 * kPi / 180.0;
  scan.bearing_step_rad = step_deg * kPi / 180.0;
  scan.beam_period_us = 1e6 / rate_hz * step_deg / 360.0;
  scan.ranges_m.resize(static_cast<std::size_t>(num_beams));
  scan.intensities.resize(scan.ranges_m.size());
  return scan;
}

void expect_every_sweep(const device::ColaDeviceModel& model, const laser::Scan& geometry) {
  ColaProtocol cola;
  // 32 bits of microseconds wrap after 10 s.
  device::ColaDevice device(model, {kNoon - (std::int64_t{1} << 32) + 10'000'000, 30e-6});
  SimulatedLine line(cola, device, kNoon, 1);
  line.jitter_us = 500.0;
  device.measured(sweep_of(geometry, kNoon - 100'000, 0));  // tells it its angles
  line.connect();
  line.run_until(kNoon + 500'000);
  const Outcome outcome = run(cola, device, line, geometry, 1e6 / model.rate_hz, 400);
  EXPECT_EQ(outcome.num_wrong, 0) << model.name;
  EXPECT_GE(static_cast<int>(outcome.errors_us.size()), 397) << model.name;
  EXPECT_LT(worst(outcome.errors_us), 1500.0) << model.name;
  EXPECT_EQ(cola.counts().num_bad, 0) << model.name;
}

// What --emulate plays: a scanner that is like the scans of a log, whose beams may have no times.
TEST(EmulatedLaser, IsLikeItsScansInEitherProtocol) {
  for (const auto kind : {LaserProtocol::kScip, LaserProtocol::kCola}) {
    laser::Scan scan = hokuyo_geometry(1440, 0, 1080, 540, 100e3);
    scan.range_min_m = 0.05;
    scan.range_max_m = 20.0;
    if (kind == LaserProtocol::kCola) scan.beam_period_us = 0.0;
    const auto device = device::make_emulated_laser(kind, kNoon - 1'000'000);
    const auto protocol = make_laser_protocol({"", kind, 0.04});
    SimulatedLine line(*protocol, *device, kNoon, 1);
    line.connect();  // before it has measured: it answers when it is asked again
    int num_scans = 0;
    for (int i = 0; i < 100; ++i) {
      const std::int64_t utime = kNoon + i * 100'000;
      line.run_until(utime);
      device->measured(sweep_of(scan, utime, i));
      for (const Measurement& m : protocol->take_measurements()) {
        laser::Scan out = std::get<laser::Scan>(m);
        out.utime += 40'000;  // what the rig says that it is late
        const auto index =
            static_cast<int>(std::lround(static_cast<double>(out.utime - kNoon) / 1e5));
        EXPECT_EQ(out.ranges_m, sweep_of(scan, utime, index).ranges_m);
        EXPECT_NEAR(out.beam_period_us, 100e3 / 1440, 1e-3);
        ++num_scans;
      }
    }
    EXPECT_GE(num_scans, 85);
  }
}

TEST(EmulatedSick, EverySweepComesWithItsRangesBearingsAndTime) {
  device::ColaDeviceModel model;
  model.name = "TiM561-2050101";
  model.rate_hz = 15.0;
  expect_every_sweep(model, sick_geometry(811, 1.0 / 3.0, 15.0));
  model.allows_login = false;
  model.sends_intensities = true;
  expect_every_sweep(model, sick_geometry(811, 1.0 / 3.0, 15.0));
  model.name = "LMS15x_FieldEval";
  model.rate_hz = 25.0;
  expect_every_sweep(model, sick_geometry(1081, 0.25, 25.0));
  model.is_binary = true;
  expect_every_sweep(model, sick_geometry(1081, 0.25, 25.0));
  model.stamps_end = true;
  expect_every_sweep(model, sick_geometry(1081, 0.25, 25.0));
}

}  // namespace
}  // namespace orchard::device
