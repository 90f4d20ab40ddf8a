// SPDX-License-Identifier: BSD-3-Clause
#include "detector/detection_precomputer.hpp"

#include <utility>

namespace orchard::procs {
namespace {

bool are_equal(const std::optional<detection::Motion>& a,
               const std::optional<detection::Motion>& b) {
  if (!a || !b) return !a && !b;
  return a->utime == b->utime && a->speed_mps == b->speed_mps &&
         a->yaw_rate_radps == b->yaw_rate_radps;
}

bool are_equal(const std::shared_ptr<const vision::Image>& a,
               const std::shared_ptr<const vision::Image>& b) {
  if (!a || !b) return !a && !b;
  return a->utime == b->utime && a->seq == b->seq;
}

}  // namespace

void PrecomputedDetections::compute() {
  if (scan_alone_ != nullptr) alone = detection::detect(*scan_alone_, nullptr, *rig_);
  for (Pair& p : pairs) {
    p.judged =
        judge_pair(detection::find_by_laser(p.pair.scan, *rig_), p.pair, *rig_, p.edge_reach_px);
  }
}

bool PrecomputedDetections::Pair::is_of(const detection::ScanImagePair& other,
                                        const std::optional<double>& other_reach_px) const {
  return pair.scan.utime == other.scan.utime && pair.scan.seq == other.scan.seq &&
         are_equal(pair.image, other.image) && are_equal(pair.motion, other.motion) &&
         edge_reach_px == other_reach_px;
}

DetectionPrecomputer::DetectionPrecomputer(const io::Config& config, const detection::Rig& rig,
                                           const detection::Rig* rear_rig, double edge_reach_px)
    : rig_(rig),
      rear_rig_(rear_rig),
      edge_reach_px_(edge_reach_px),
      pairer_(make_pairer(config)),
      monitor_(config.detector.extrinsics_monitor, config.camera.intrinsics.fc_px[0]) {}

std::unique_ptr<PrecomputedDetections> DetectionPrecomputer::precompute(const bus::Message& input) {
  auto precomputed = std::make_unique<PrecomputedDetections>();
  precomputed->rig_ = &rig_;
  std::vector<detection::ScanImagePair> pairs;
  if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    if (!rig_.has_camera) {
      precomputed->scan_alone_ = scan;
      return precomputed;
    }
    pairs = pairer_.add(*scan);
  } else if (const auto* rear = std::get_if<laser::RearScan>(&input)) {
    if (rear_rig_ == nullptr) return nullptr;
    precomputed->rig_ = rear_rig_;
    precomputed->scan_alone_ = rear;
    return precomputed;
  } else if (const auto* image = std::get_if<vision::Image>(&input)) {
    if (rig_.has_camera) pairs = pairer_.add(*image);
  } else if (const auto* odometry = std::get_if<pose::Odometry>(&input)) {
    pairs = pairer_.add(
        detection::Motion{odometry->utime, odometry->speed_mps, odometry->yaw_rate_radps});
  }
  for (detection::ScanImagePair& pair : pairs) {
    std::optional<double> reach_px;
    if (pair.image && monitor_.is_due(pair.scan.utime)) {
      reach_px = edge_reach_px_;
      monitor_.add(pair.scan.utime, {});
    }
    precomputed->pairs.push_back({std::move(pair), reach_px, {}});
  }
  return precomputed;
}

detection::ScanImagePairer make_pairer(const io::Config& config) {
  return {config.detector.pairing_tolerance_s, config.detector.image_wait_s,
          config.detector.use_odometry, config.camera.delay_s};
}

}  // namespace orchard::procs
