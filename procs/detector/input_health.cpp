// SPDX-License-Identifier: BSD-3-Clause
#include "detector/input_health.hpp"

#include "bus/messages/channel.hpp"
#include "text/number_text.hpp"

namespace orchard::procs {
namespace {

/// Consecutive scans without a picture before a warning: two seconds at 10 Hz.
constexpr std::int64_t kScansWithoutPicture = 20;

laser::OwnReturnsConfig own_returns_config(const laser::LaserConfig& laser,
                                           const laser::SegmentationConfig& segmentation) {
  laser::OwnReturnsConfig config;
  config.range_min_m = segmentation.range_min_m;
  config.range_max_m = segmentation.range_max_m;
  config.min_beams = segmentation.min_beams;
  config.range_sd_m = laser.range_sd_m;
  config.range_sd_fraction = laser.range_sd_fraction;
  config.blind = segmentation.blind_sector();
  return config;
}

std::string own_returns_text(const laser::OwnReturns& own, bus::Channel channel) {
  const auto found = own.found();
  if (!found) return {};
  return std::string(bus::info(channel).name) + " has returns nearer than " +
         fixed_text(found->reach_m, 1) +
         " m that move with the robot (its own body, or a person walking with it) and become "
         "landmarks. To ignore them, set detector.segmentation.blind_centre_rad: " +
         fixed_text(found->sector.centre_rad, 2) +
         " and blind_half_width_rad: " + fixed_text(found->sector.half_width_rad, 2);
}

}  // namespace

InputHealth::InputHealth(const io::Config& config)
    : has_camera_(config.camera.enabled),
      width_px_(config.camera.intrinsics.width_px),
      height_px_(config.camera.intrinsics.height_px),
      own_returns_(own_returns_config(config.laser, config.detector.segmentation)),
      rear_own_returns_(own_returns_config(config.laser_rear, config.detector.segmentation)) {}

void InputHealth::note_no_picture() {
  ++num_without_picture_;
  ++num_since_picture_;
}

void InputHealth::note_picture(bool without_motion) {
  ++num_pictures_;
  num_since_picture_ = 0;
  last_without_motion_ = without_motion;
}

void InputHealth::note_needed_picture(const vision::Image& image, bool is_usable) {
  if (is_usable) {
    ++num_usable_;
    num_since_usable_ = 0;
    return;
  }
  ++num_unusable_;
  ++num_since_usable_;
  bad_width_px_ = image.width_px;
  bad_height_px_ = image.height_px;
}

std::string InputHealth::text(bool ended, std::int64_t num_without_motion) const {
  std::string all;
  const auto add = [&](const std::string& text) {
    if (!text.empty()) all += (all.empty() ? "" : "; ") + text;
  };
  add(odometry_text(ended, num_without_motion));
  add(picture_text(ended));
  add(unusable_text(ended));
  add(own_returns_text(own_returns_, bus::Channel::kScan));
  add(own_returns_text(rear_own_returns_, bus::Channel::kScanRear));
  return all;
}

std::string InputHealth::picture_text(bool ended) const {
  if (!has_camera_) return {};
  const std::int64_t num_scans = num_pictures_ + num_without_picture_;
  const bool is_wanting = ended ? num_without_picture_ > 0 &&
                                      (num_pictures_ == 0 || (num_scans >= kScansWithoutPicture &&
                                                              num_pictures_ < num_scans / 2))
                                : num_since_picture_ >= kScansWithoutPicture;
  if (!is_wanting) return {};
  return "no IMAGE (from the camera driver) for " +
         std::to_string(ended ? num_without_picture_ : num_since_picture_) + " of " +
         std::to_string(num_scans) + " scans: their detections are UNSEEN, neither tree nor object";
}

std::string InputHealth::unusable_text(bool ended) const {
  const bool is_wanting =
      ended ? num_unusable_ > num_usable_ : num_since_usable_ >= kScansWithoutPicture;
  if (!is_wanting) return {};
  const std::string which = std::to_string(ended ? num_unusable_ : num_since_usable_) + " of " +
                            std::to_string(num_usable_ + num_unusable_) + " pictures are unusable";
  const std::string outcome = ": their detections are UNSEEN";
  if (bad_width_px_ == width_px_ && bad_height_px_ == height_px_) {
    return which + " (IMAGE cannot be decoded)" + outcome;
  }
  const auto size_text = [](std::int32_t width_px, std::int32_t height_px) {
    return std::to_string(width_px) + " x " + std::to_string(height_px);
  };
  return which + " (IMAGE is " + size_text(bad_width_px_, bad_height_px_) +
         " px, but camera.width_px and height_px are " + size_text(width_px_, height_px_) + ")" +
         outcome;
}

std::string InputHealth::odometry_text(bool ended, std::int64_t num_without_motion) const {
  if (num_without_motion == 0 || (!ended && !last_without_motion_)) return {};
  return "no ODOMETRY (from the odometry driver) for " + std::to_string(num_without_motion) +
         " of " + std::to_string(num_pictures_) +
         " pictures: they are used without compensating the motion between scan and picture "
         "(detector.use_odometry)";
}

}  // namespace orchard::procs
