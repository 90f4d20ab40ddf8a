// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/trunk_collector.hpp"
#include "geometry/pose2.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/angles.hpp"

namespace orchard::cli {
namespace {

/// Min number of beams: the width of narrower objects is unreliable.
constexpr int kMinBeams = 4;

using geometry::Pose2;

std::optional<Pose2> pose_at(const std::vector<pose::PoseEstimate>& poses, std::int64_t utime,
                             std::int64_t gap_max_us) {
  const auto after = std::lower_bound(
      poses.begin(), poses.end(), utime,
      [](const pose::PoseEstimate& pose, std::int64_t t) { return pose.utime < t; });
  if (after == poses.end()) return std::nullopt;
  if (after->utime == utime) return Pose2{after->x_m, after->y_m, after->yaw_rad};
  if (after == poses.begin()) return std::nullopt;
  const pose::PoseEstimate &a = *(after - 1), &b = *after;
  if (b.utime - a.utime > gap_max_us) return std::nullopt;
  const double fraction =
      static_cast<double>(utime - a.utime) / static_cast<double>(b.utime - a.utime);
  return Pose2{a.x_m + fraction * (b.x_m - a.x_m), a.y_m + fraction * (b.y_m - a.y_m),
               a.yaw_rad + fraction * geometry::wrap_angle_rad(b.yaw_rad - a.yaw_rad)};
}

}  // namespace

TrunkCollector::TrunkCollector(const io::Config& config, int log, bool crops)
    : rig_(config.laser, config.camera, config.detector),
      pairer_(config.detector.pairing_tolerance_s, config.detector.image_wait_s, false,
              config.camera.delay_s),
      pose_gap_max_us_(std::llround(config.mapper.pose_gap_max_s * 1e6)),
      log_(log),
      crops_(crops) {}

std::vector<bus::Channel> TrunkCollector::inputs() const {
  std::vector<bus::Channel> channels{bus::Channel::kScan, bus::Channel::kPose};
  if (rig_.has_camera) channels.push_back(bus::Channel::kImage);
  return channels;
}

void TrunkCollector::handle(const bus::Message& input, const bus::Outbox&) {
  if (const auto* pose = std::get_if<pose::PoseEstimate>(&input)) {
    poses_.push_back(*pose);
  } else if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    if (!rig_.has_camera) return observe({*scan, nullptr, std::nullopt});
    for (const auto& pair : pairer_.add(*scan)) observe(pair);
  } else if (const auto* image = std::get_if<vision::Image>(&input)) {
    for (const auto& pair : pairer_.add(*image)) observe(pair);
  }
}

void TrunkCollector::flush(const bus::Outbox&) {
  for (const auto& pair : pairer_.flush()) observe(pair);
}

std::vector<calibration::TrunkObservation> TrunkCollector::observations() const {
  std::vector<calibration::TrunkObservation> observations = in_base_;
  for (calibration::TrunkObservation& observation : observations) {
    const auto T_map_base = pose_at(poses_, observation.utime, pose_gap_max_us_);
    if (!T_map_base) continue;
    const Eigen::Vector2d p_map = transform(*T_map_base, {observation.x_m, observation.y_m});
    observation.x_m = p_map.x();
    observation.y_m = p_map.y();
    observation.in_map = true;
  }
  return observations;
}

void TrunkCollector::observe(const detection::ScanImagePair& pair) {
  if (pair.image || !rig_.has_camera) ++num_pairs_;
  calibration::ObserveOptions options;
  options.min_beams = kMinBeams;
  options.crops = crops_;
  for (auto& seen : calibration::observe_trunks(pair.scan, pair.image.get(), rig_, options)) {
    seen.log = log_;
    in_base_.push_back(std::move(seen));
  }
}

}  // namespace orchard::cli
