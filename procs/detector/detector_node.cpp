// SPDX-License-Identifier: BSD-3-Clause
#include "detector/detector_node.hpp"

#include <utility>

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

JudgedPair judge_pair(detection::LaserFindings findings, const detection::ScanImagePair& pair,
                      const detection::Rig& rig, bool wants_sight) {
  JudgedPair judged;
  std::optional<vision::PictureReader> picture;
  if (pair.image) picture.emplace(*pair.image);
  if (picture && wants_sight) {
    judged.sight = detection::camera_sight(findings, *picture, rig, pair.motion);
  }
  judged.result = detection::judge_by_camera(std::move(findings), picture ? &*picture : nullptr,
                                             rig, pair.motion);
  return judged;
}

void PrecomputedDetections::compute() {
  if (scan_alone_ != nullptr) alone = detection::detect(*scan_alone_, nullptr, *rig_);
  for (Pair& p : pairs) {
    p.judged =
        judge_pair(detection::find_by_laser(p.pair.scan, *rig_), p.pair, *rig_, p.wants_sight);
  }
}

bool PrecomputedDetections::Pair::is_of(const detection::ScanImagePair& other,
                                        bool other_wants_sight) const {
  return pair.scan.utime == other.scan.utime && pair.scan.seq == other.scan.seq &&
         are_equal(pair.image, other.image) && are_equal(pair.motion, other.motion) &&
         wants_sight == other_wants_sight;
}

DetectionPrecomputer::DetectionPrecomputer(const io::Config& config, const detection::Rig& rig,
                                           const detection::Rig* rear_rig)
    : rig_(rig), rear_rig_(rear_rig), pairer_(make_pairer(config)) {}

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
    if (rig_.has_camera) {
      precomputed->image = std::make_shared<const vision::Image>(*image);
      pairs = pairer_.add(precomputed->image);
    }
  } else if (const auto* odometry = std::get_if<pose::Odometry>(&input)) {
    pairs = pairer_.add(
        detection::Motion{odometry->utime, odometry->speed_mps, odometry->yaw_rate_radps});
  }
  for (detection::ScanImagePair& pair : pairs) {
    const bool wants_sight = pair.image && look_times_.take(pair.scan.utime);
    precomputed->pairs.push_back({std::move(pair), wants_sight, {}});
  }
  return precomputed;
}

detection::ScanImagePairer make_pairer(const io::Config& config) {
  return {config.detector.pairing_tolerance_s, config.detector.image_wait_s,
          config.detector.use_odometry, config.camera.delay_s};
}

DetectorNode::DetectorNode(const io::Config& config)
    : levelled_(config),
      rig_(config.laser, config.camera, config.detector),
      pairer_(make_pairer(config)),
      camera_check_(rig_),
      health_(config),
      range_noise_(config.laser, config.detector.segmentation.blind_sector(),
                   config.detector.segmentation.range_max_m, config.detector.segmentation.jump_m) {
  if (config.laser_rear.enabled) {
    rear_rig_.emplace(config.laser_rear, config.camera, config.detector);
    joiner_.emplace(config.laser, config.detector.image_wait_s, levelled_.has_wheels());
  }
  precomputer_.emplace(config, rig_, rear_rig_ ? &*rear_rig_ : nullptr);
}

std::vector<bus::Channel> DetectorNode::inputs() const {
  std::vector<bus::Channel> channels{bus::Channel::kScan};
  if (rig_.has_camera) channels.push_back(bus::Channel::kImage);
  if (compensates_motion()) channels.push_back(bus::Channel::kOdometry);
  if (joiner_) channels.push_back(bus::Channel::kScanRear);
  levelled_.add_channels(channels);
  return channels;
}

bus::InputNeed DetectorNode::need_of(bus::Channel channel) const {
  const bool is_own = channel == bus::Channel::kOdometry && compensates_motion();
  const bool levels_only = levelled_.reads(channel) && !is_own;
  return levels_only ? bus::InputNeed::kOptional : Node::need_of(channel);
}

/// Whether the detector itself uses ODOMETRY, not only to level its scans.
bool DetectorNode::compensates_motion() const {
  return (rig_.has_camera && rig_.detector.use_odometry) || (joiner_ && levelled_.has_wheels());
}

void DetectorNode::handle(const bus::Message& input, const bus::Outbox& send) {
  levelled_.pass(input, [&](const bus::Message& message) { use(message, send); });
}

void DetectorNode::use(const bus::Message& input, const bus::Outbox& send) {
  std::vector<detection::ScanImagePair> pairs;
  if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    health_.note_scan(*scan);
    range_noise_.add(*scan);
    if (!rig_.has_camera) {
      return send_result(detect_alone(*scan, rig_), detection::turn_us(*scan), send);
    }
    findings_.emplace_back();
    if (!precomputed_) findings_.back() = detection::find_by_laser(*scan, rig_);
    pairs = pairer_.add(*scan);
  } else if (const auto* image = std::get_if<vision::Image>(&input)) {
    if (rig_.has_camera) {
      pairs = pairer_.add(precomputed_ && precomputed_->image
                              ? precomputed_->image
                              : std::make_shared<const vision::Image>(*image));
    }
  } else if (const auto* rear = std::get_if<laser::RearScan>(&input)) {
    if (!joiner_) return;
    health_.note_rear_scan(*rear);
    return send_views(joiner_->add_rear(detect_alone(*rear, *rear_rig_).detections), send);
  } else if (const auto* odometry = std::get_if<pose::Odometry>(&input)) {
    const detection::Motion motion{odometry->utime, odometry->speed_mps, odometry->yaw_rate_radps};
    if (joiner_ && levelled_.has_wheels()) send_views(joiner_->add(motion), send);
    pairs = pairer_.add(motion);
  }
  for (const auto& pair : pairs) send_detections(pair, send);
}

void DetectorNode::flush(const bus::Outbox& send) {
  levelled_.flush([&](const bus::Message& message) { use(message, send); });
  for (const auto& pair : pairer_.flush()) send_detections(pair, send);
  if (joiner_) send_views(joiner_->flush(), send);
  camera_check_.finish();
  ended_ = true;
}

bus::NodeCounts DetectorNode::counts() const { return {pairer_.num_late(), num_unusable_}; }

std::string DetectorNode::waiting_for() const {
  if (intensities_missing_) {
    return "SCAN has no intensities, which detector.segmentation.reflector needs; switch them on "
           "in the laser driver or set reflector to ignored";
  }
  if (const auto view = joiner_ ? joiner_->waiting_utime() : std::nullopt) {
    return "SCAN at " + fixed_text(static_cast<double>(*view) * 1e-6, 3) +
           " s waits for SCAN.rear of that time or later (from the second laser driver)";
  }
  const auto utime = pairer_.waiting_scan_utime();
  if (!utime) return {};
  return "SCAN at " + fixed_text(static_cast<double>(*utime) * 1e-6, 3) + " s waits for an IMAGE" +
         (rig_.detector.use_odometry
              ? " (from the camera driver) and ODOMETRY (from the odometry driver)"
              : " (from the camera driver)");
}

std::string DetectorNode::warning() const {
  const std::string health = health_.text(ended_, pairer_.num_without_motion());
  const std::string levelled = levelled_.warning();
  return health + (health.empty() || levelled.empty() ? "" : "; ") + levelled;
}

std::vector<Finding> DetectorNode::findings() const {
  std::vector<Finding> findings = camera_check_.findings();
  if (auto noise = range_noise_.finding()) findings.push_back(*std::move(noise));
  return findings;
}

std::unique_ptr<bus::Precomputation> DetectorNode::precompute(const bus::Message& input) {
  // A scan that is levelled waits for its IMU.
  return levelled_.is_active() ? nullptr : precomputer_->precompute(input);
}

void DetectorNode::use_precomputed(std::unique_ptr<bus::Precomputation> precomputed) {
  precomputed_.reset(dynamic_cast<PrecomputedDetections*>(precomputed.release()));
  num_precomputed_used_ = 0;
}

detection::DetectResult DetectorNode::detect_alone(const laser::Scan& scan,
                                                   const detection::Rig& rig) {
  if (precomputed_ && precomputed_->alone) return std::move(*precomputed_->alone);
  return detection::detect(scan, nullptr, rig);
}

JudgedPair DetectorNode::judge(const detection::ScanImagePair& pair) {
  std::optional<detection::LaserFindings> findings = std::move(findings_.front());
  findings_.pop_front();
  const bool wants_sight = pair.image && look_times_.take(pair.scan.utime);
  if (precomputed_ && num_precomputed_used_ < precomputed_->pairs.size()) {
    PrecomputedDetections::Pair& precomputed = precomputed_->pairs[num_precomputed_used_++];
    if (precomputed.is_of(pair, wants_sight)) return std::move(precomputed.judged);
  }
  if (!findings) findings = detection::find_by_laser(pair.scan, rig_);
  return judge_pair(*std::move(findings), pair, rig_, wants_sight);
}

void DetectorNode::send_detections(const detection::ScanImagePair& pair, const bus::Outbox& send) {
  JudgedPair judged = judge(pair);
  if (pair.image) {
    health_.note_picture(rig_.detector.use_odometry && !pair.motion);
  } else {
    health_.note_no_picture();
  }
  if (judged.sight) camera_check_.add(*std::move(judged.sight));
  detection::DetectResult& result = judged.result;
  if (result.image_needed) health_.note_needed_picture(*pair.image, !result.image_unusable);
  send_result(std::move(result), detection::turn_us(pair.scan), send);
}

void DetectorNode::send_result(detection::DetectResult result, std::int64_t turn_us,
                               const bus::Outbox& send) {
  if (result.image_unusable || result.intensities_missing) ++num_unusable_;
  intensities_missing_ = result.intensities_missing;
  if (joiner_) return send_views(joiner_->add_front(std::move(result.detections), turn_us), send);
  send_views({std::move(result.detections)}, send);
}

void DetectorNode::send_views(std::vector<detection::Detections> views, const bus::Outbox& send) {
  for (detection::Detections& view : views) {
    view.seq = next_seq_++;
    send(std::move(view));
  }
}

}  // namespace orchard::procs
