// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/delay_collector.hpp"

#include <cmath>

#include "detection/detect.hpp"
#include "geometry/angles.hpp"

namespace orchard::cli {
namespace {

/// Search window of edges around their expected positions: 0.2 s at 0.5 rad/s.
constexpr double kReach_deg = 6.0;

}  // namespace

DelayCollector::DelayCollector(const io::Config& config, std::int32_t first_picture)
    : PairNode({bus::Channel::kScan, bus::Channel::kImage, bus::Channel::kOdometry},
               {config.detector.pairing_tolerance_s, config.detector.image_wait_s, true,
                config.camera.delay_s}),
      rig_(config.laser, config.camera, config.detector),
      reach_px_(config.camera.intrinsics.fc_px[0] * std::tan(kReach_deg * geometry::kPi / 180.0)),
      next_picture_(first_picture) {}

void DelayCollector::observe(detection::ScanImagePair pair) {
  if (!pair.image) return;
  ++num_pairs_;
  if (!pair.motion) return;
  ++num_moving_;
  const auto findings = detection::find_by_laser(pair.scan, rig_);
  for (auto& seen : calibration::delay_observations(findings, *pair.image, rig_, *pair.motion,
                                                    reach_px_, next_picture_)) {
    observations_.push_back(std::move(seen));
  }
  ++next_picture_;
}

}  // namespace orchard::cli
