// SPDX-License-Identifier: BSD-3-Clause
#include "pose/pose_config.hpp"

#include <algorithm>

namespace orchard::pose {
namespace {

/// Max delay of a GNSS fix by computation and serial transmission; a later fix is lost. physical:
/// 0.05 s over USB, up to half a second at 9600 baud.
constexpr double kGnssWait_s = 0.5;

double gnss_wait_s(const PoseConfig& config) {
  return std::max(config.reorder_window_s, kGnssWait_s);
}

}  // namespace

bool reads_scans(const PoseConfig& config) {
  return config.motion == MotionSource::kScans &&
         (config.mode == PoseMode::kOdometry || config.mode == PoseMode::kSlam ||
          config.mode == PoseMode::kPriorMap);
}

PoseConfig as_fused(PoseConfig config) {
  if (config.mode == PoseMode::kFused) return config;
  config.fusion.use_imu = config.fusion.use_gnss = false;
  config.fusion.use_fixes = config.fusion.learns_wheels =
      config.mode == PoseMode::kFixesAndOdometry;
  return config;
}

MeasurementWaits expected_measurements(const PoseConfig& config) {
  MeasurementWaits waits_s;
  const auto expect = [&waits_s](MeasurementKind kind, double wait_s) {
    waits_s[static_cast<std::size_t>(kind)] = wait_s;
  };
  switch (config.mode) {
    case PoseMode::kStationary:
      expect(MeasurementKind::kScan, config.reorder_window_s);
      break;
    case PoseMode::kFixes:
      expect(MeasurementKind::kPoseFix, config.reorder_window_s);
      break;
    case PoseMode::kPriorMap:
      expect(MeasurementKind::kOdometry, config.reorder_window_s);
      if (reads_scans(config)) expect(MeasurementKind::kScan, config.reorder_window_s);
      expect(MeasurementKind::kDetections, config.slam.detections_wait_s);
      break;
    case PoseMode::kOdometry:
    case PoseMode::kFixesAndOdometry:
    case PoseMode::kFused: {
      if (reads_scans(config)) {
        expect(MeasurementKind::kScan, config.reorder_window_s);
        expect(MeasurementKind::kOdometry, config.reorder_window_s);
        break;
      }
      const FusionConfig fusion = as_fused(config).fusion;
      expect(MeasurementKind::kOdometry, config.reorder_window_s);
      if (fusion.use_imu) expect(MeasurementKind::kImu, config.reorder_window_s);
      if (fusion.use_gnss) expect(MeasurementKind::kGnss, gnss_wait_s(config));
      if (fusion.use_fixes) expect(MeasurementKind::kPoseFix, config.reorder_window_s);
      break;
    }
    case PoseMode::kSlam:
      expect(MeasurementKind::kScan, config.reorder_window_s);
      expect(MeasurementKind::kOdometry, config.reorder_window_s);
      expect(MeasurementKind::kDetections, config.slam.detections_wait_s);
      if (config.slam.use_gnss) expect(MeasurementKind::kGnss, gnss_wait_s(config));
      if (config.slam.use_fixes) expect(MeasurementKind::kPoseFix, config.reorder_window_s);
      break;
  }
  return waits_s;
}

}  // namespace orchard::pose
