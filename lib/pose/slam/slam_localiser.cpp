// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/slam_localiser.hpp"

#include <cmath>
#include <utility>
#include <variant>

#include "pose/graph/georeference.hpp"
#include "pose/graph/receiver_model.hpp"

namespace orchard::pose {

SlamLocaliser::SlamLocaliser(const PoseConfig& config, const laser::LaserConfig& mount,
                             const laser::BlindSector& blind,
                             std::shared_ptr<ChunkAllocator> memory)
    : config_(config),
      mount_(mount),
      blind_(blind),
      gnss_(config.gnss),
      slam_(config.slam, config.scan_motion, mount, std::move(memory)) {
  if (config.motion == MotionSource::kScans) scan_motion_.emplace(config.scan_motion, mount, blind);
  slam_.set_default_noise(config.speed_sd_fraction, config.yaw_rate_sd_radps);
}

void SlamLocaliser::add(const Measurement& measurement) {
  if (const auto* odometry = std::get_if<Odometry>(&measurement)) {
    if (!scan_motion_) slam_.add(*odometry);
  } else if (const auto* scan = std::get_if<laser::Scan>(&measurement)) {
    scan_ = *scan;
    if (!scan_motion_) return;
    if (const auto motion = scan_motion_->add(*scan)) {
      slam_.add_motion(motion->utime_to, motion->T_from_to, motion->covariance);
    }
  } else if (const auto* seen = std::get_if<detection::Detections>(&measurement)) {
    TrunkSlam::ScanSource source;
    if (scan_ && scan_->utime == seen->utime) {
      source = [this](const Eigen::Vector3d& velocity) {
        return surface_points(*scan_, mount_, blind_, velocity, config_.scan_motion);
      };
    }
    slam_.add(*seen, source);
  } else if (const auto* fix = std::get_if<PoseFix>(&measurement)) {
    if (config_.slam.use_fixes) add(*fix);
  } else if (const auto* gnss = std::get_if<Gnss>(&measurement)) {
    if (config_.slam.use_gnss) add(*gnss);
  }
}

void SlamLocaliser::finish() {
  slam_.finish();
  at_end_ = {rejected_fixes_text(rejected_fixes(slam_.graph())), receiver_text(slam_.graph())};
}

std::string SlamLocaliser::warning() const {
  std::string all = slam_.warning();
  for (const std::string& text : at_end_) {
    if (!all.empty() && !text.empty()) all += "; ";
    all += text;
  }
  return all;
}

void SlamLocaliser::add(const PoseFix& fix) {
  AbsolutePosition position;
  position.p_map = {fix.x_m, fix.y_m};
  position.covariance << fix.covariance[0], fix.covariance[1], fix.covariance[1], fix.covariance[3];
  if (fix.covariance[0] <= 0.0 || fix.covariance[3] <= 0.0) {
    position.covariance =
        config_.fix_position_sd_m * config_.fix_position_sd_m * Eigen::Matrix2d::Identity();
  }
  position.has_yaw = fix.has_yaw;
  position.yaw_rad = fix.yaw_rad;
  position.yaw_sd_rad =
      fix.covariance[5] > 0.0 ? std::sqrt(fix.covariance[5]) : config_.fix_yaw_sd_rad;
  slam_.add_position(fix.utime, position);
}

void SlamLocaliser::add(const Gnss& gnss) {
  const std::optional<GnssPosition> gnss_position = gnss_.add(gnss);
  if (!gnss_position) return;
  AbsolutePosition position;
  position.lever_base_m = {config_.gnss.antenna_m[0], config_.gnss.antenna_m[1]};
  position.p_map = gnss_position->p_enu_m;
  position.covariance = gnss_position->covariance;
  position.is_gnss = true;
  slam_.add_position(gnss.utime, position);
}

}  // namespace orchard::pose
