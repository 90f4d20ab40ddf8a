// SPDX-License-Identifier: BSD-3-Clause
#include "pose/make_localiser.hpp"

#include <algorithm>
#include <utility>

#include "pose/filter/fixes.hpp"
#include "pose/filter/fusion.hpp"
#include "pose/prior_map/prior_map_localiser.hpp"
#include "pose/scan_matching/scan_odometry.hpp"
#include "pose/slam/slam_localiser.hpp"
#include "pose/stationary.hpp"

namespace orchard::pose {
namespace {

/// Max delay of a GNSS fix by computation and serial transmission: 0.05 s over USB, up to half a
/// second at 9600 baud. A later fix is lost.
constexpr double kGnssWait_s = 0.5;

double gnss_wait_s(const PoseConfig& config) {
  return std::max(config.reorder_window_s, kGnssWait_s);
}

bool reads_scans(const PoseConfig& config) {
  return config.mode == PoseMode::kOdometry && config.motion == MotionSource::kScans;
}

/// Returns the configuration with which mode `fused` uses what this mode names, and nothing else.
PoseConfig as_fused(PoseConfig config) {
  if (config.mode == PoseMode::kFused) return config;
  config.fusion.use_imu = config.fusion.use_gnss = false;
  config.fusion.use_fixes = config.fusion.learns_wheels =
      config.mode == PoseMode::kFixesAndOdometry;
  return config;
}

}  // namespace

std::unique_ptr<Localiser> make_localiser(const PoseConfig& config, const PriorMapData& earlier,
                                          const laser::LaserConfig& laser,
                                          const laser::BlindSector& blind,
                                          std::shared_ptr<ChunkAllocator> memory) {
  switch (config.mode) {
    case PoseMode::kStationary:
      return std::make_unique<Stationary>();
    case PoseMode::kFixes:
      return std::make_unique<Fixes>(config);
    case PoseMode::kPriorMap:
      return std::make_unique<PriorMapLocaliser>(config, earlier, laser, blind);
    case PoseMode::kSlam:
      return std::make_unique<SlamLocaliser>(config, laser, blind, std::move(memory));
    case PoseMode::kOdometry:
    case PoseMode::kFixesAndOdometry:
    case PoseMode::kFused:
      break;
  }
  if (reads_scans(config)) {
    return std::make_unique<ScanOdometry>(config.scan_motion, laser, blind);
  }
  return std::make_unique<Fusion>(as_fused(config));
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
      expect(config.motion == MotionSource::kScans ? MeasurementKind::kScan
                                                   : MeasurementKind::kOdometry,
             config.reorder_window_s);
      expect(MeasurementKind::kDetections, config.slam.detections_wait_s);
      break;
    case PoseMode::kOdometry:
    case PoseMode::kFixesAndOdometry:
    case PoseMode::kFused: {
      if (reads_scans(config)) {
        expect(MeasurementKind::kScan, config.reorder_window_s);
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
      if (config.motion == MotionSource::kWheels) {
        expect(MeasurementKind::kOdometry, config.reorder_window_s);
      }
      expect(MeasurementKind::kDetections, config.slam.detections_wait_s);
      if (config.slam.use_gnss) expect(MeasurementKind::kGnss, gnss_wait_s(config));
      if (config.slam.use_fixes) expect(MeasurementKind::kPoseFix, config.reorder_window_s);
      break;
  }
  return waits_s;
}

}  // namespace orchard::pose
