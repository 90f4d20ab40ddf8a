// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/appearance/appearance_collector.hpp"

#include <utility>

#include "detection/trunk_view.hpp"
#include "vision/appearance.hpp"
#include "vision/exposure.hpp"
#include "vision/decode.hpp"

namespace orchard {

AppearanceCollector::AppearanceCollector(const io::Config& config, int stride)
    : rig_(config.laser, config.camera, config.detector),
      pairer_(config.detector.pairing_tolerance_s, config.detector.image_wait_s,
              config.detector.use_odometry, config.camera.delay_s),
      stride_(stride) {}

std::vector<bus::Channel> AppearanceCollector::inputs() const {
  if (!rig_.detector.use_odometry) return {bus::Channel::kScan, bus::Channel::kImage};
  return {bus::Channel::kScan, bus::Channel::kImage, bus::Channel::kOdometry};
}

void AppearanceCollector::handle(const bus::Message& input, const bus::Outbox&) {
  if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    for (const auto& pair : pairer_.add(*scan)) observe(pair);
  } else if (const auto* image = std::get_if<vision::Image>(&input)) {
    for (const auto& pair : pairer_.add(*image)) observe(pair);
  } else if (const auto* odometry = std::get_if<pose::Odometry>(&input)) {
    const detection::Motion motion{odometry->utime, odometry->speed_mps, odometry->yaw_rate_radps};
    for (const auto& pair : pairer_.add(motion)) observe(pair);
  }
}

void AppearanceCollector::flush(const bus::Outbox&) {
  for (const auto& pair : pairer_.flush()) observe(pair);
}

void AppearanceCollector::observe(const detection::ScanImagePair& pair) {
  if (!pair.image || num_pairs_++ % stride_ != 0) return;
  detection::LaserFindings findings = detection::find_by_laser(pair.scan, rig_);
  findings.detections.image_utime = pair.image->utime;
  auto pixels = vision::decode(*pair.image, detection::picture_of(rig_));
  if (!pixels) return;
  const auto to_exposure = detection::to_picture(findings, *pair.image, rig_, pair.motion);
  for (const vision::PixelBlock& exposed : vision::learnt_exposures(std::move(*pixels))) {
    for (const detection::Candidate& candidate : findings.candidates) {
      const auto view = detection::view_of(candidate.segment, rig_, to_exposure);
      if (!view) continue;
      windows_.push_back(
          {findings.detections.utime, candidate.index,
           vision::appearance_features(exposed, detection::trunk_window(*view, rig_))});
    }
  }
  messages_.push_back(std::move(findings.detections));
}

}  // namespace orchard
