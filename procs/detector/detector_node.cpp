// SPDX-License-Identifier: BSD-3-Clause
#include "detector/detector_node.hpp"

#include <cmath>
#include <utility>

#include "geometry/angles.hpp"
#include "pose/pose_config.hpp"
#include "text/number_text.hpp"

namespace orchard::procs {
namespace {

/// True if the detector or orchard-pose uses the rig's odometry.
bool has_wheels(const io::Config& config) {
  const auto odometry = static_cast<std::size_t>(pose::MeasurementKind::kOdometry);
  return config.detector.use_odometry ||
         pose::expected_measurements(config.pose)[odometry].has_value();
}

}  // namespace

DetectorNode::DetectorNode(const io::Config& config)
    : rig_(config.laser, config.camera, config.detector),
      pairer_(make_pairer(config)),
      monitor_(config.detector.extrinsics_monitor, config.camera.intrinsics.fc_px[0]),
      edge_reach_px_(config.camera.intrinsics.fc_px[0] *
                     std::tan(detection::tuning::kSearchWindow_deg * geometry::kPi / 180.0)),
      has_wheels_(has_wheels(config)),
      health_(config) {
  if (config.laser_rear.enabled) {
    rear_rig_.emplace(config.laser_rear, config.camera, config.detector);
    joiner_.emplace(config.laser, config.detector.image_wait_s, has_wheels_);
  }
  precomputer_.emplace(config, rig_, rear_rig_ ? &*rear_rig_ : nullptr, edge_reach_px_);
}

std::vector<bus::Channel> DetectorNode::inputs() const {
  std::vector<bus::Channel> channels{bus::Channel::kScan};
  if (rig_.has_camera) channels.push_back(bus::Channel::kImage);
  if ((rig_.has_camera && rig_.detector.use_odometry) || (joiner_ && has_wheels_)) {
    channels.push_back(bus::Channel::kOdometry);
  }
  if (joiner_) channels.push_back(bus::Channel::kScanRear);
  return channels;
}

void DetectorNode::handle(const bus::Message& input, const bus::Outbox& send) {
  std::vector<detection::ScanImagePair> pairs;
  if (const auto* scan = std::get_if<laser::Scan>(&input)) {
    health_.note_scan(*scan);
    if (!rig_.has_camera) {
      return send_result(detect_alone(*scan, rig_), detection::turn_us(*scan), send);
    }
    findings_.emplace_back();
    if (!precomputed_) findings_.back() = detection::find_by_laser(*scan, rig_);
    pairs = pairer_.add(*scan);
  } else if (const auto* image = std::get_if<vision::Image>(&input)) {
    if (rig_.has_camera) pairs = pairer_.add(*image);
  } else if (const auto* rear = std::get_if<laser::RearScan>(&input)) {
    if (!joiner_) return;
    health_.note_rear_scan(*rear);
    return send_views(joiner_->add_rear(detect_alone(*rear, *rear_rig_).detections), send);
  } else if (const auto* odometry = std::get_if<pose::Odometry>(&input)) {
    const detection::Motion motion{odometry->utime, odometry->speed_mps, odometry->yaw_rate_radps};
    if (joiner_ && has_wheels_) send_views(joiner_->add(motion), send);
    pairs = pairer_.add(motion);
  }
  for (const auto& pair : pairs) send_detections(pair, send);
}

void DetectorNode::flush(const bus::Outbox& send) {
  for (const auto& pair : pairer_.flush()) send_detections(pair, send);
  if (joiner_) send_views(joiner_->flush(), send);
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
  const std::string text = ended_ ? monitor_.run_summary() : monitor_.warning();
  const std::string inputs = health_.text(ended_, pairer_.num_without_motion());
  return text + (text.empty() || inputs.empty() ? "" : "; ") + inputs;
}

std::unique_ptr<bus::Precomputation> DetectorNode::precompute(const bus::Message& input) {
  return precomputer_->precompute(input);
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
  std::optional<double> edge_reach_px;
  if (pair.image && monitor_.is_due(pair.scan.utime)) edge_reach_px = edge_reach_px_;
  if (precomputed_ && num_precomputed_used_ < precomputed_->pairs.size()) {
    PrecomputedDetections::Pair& precomputed = precomputed_->pairs[num_precomputed_used_++];
    if (precomputed.is_of(pair, edge_reach_px)) return std::move(precomputed.judged);
  }
  if (!findings) findings = detection::find_by_laser(pair.scan, rig_);
  return judge_pair(*std::move(findings), pair, rig_, edge_reach_px);
}

void DetectorNode::send_detections(const detection::ScanImagePair& pair, const bus::Outbox& send) {
  JudgedPair judged = judge(pair);
  if (pair.image) {
    health_.note_picture(rig_.detector.use_odometry && !pair.motion);
  } else {
    health_.note_no_picture();
  }
  if (judged.edge_offsets_px) monitor_.add(pair.scan.utime, *judged.edge_offsets_px);
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
