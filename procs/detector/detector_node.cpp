// SPDX-License-Identifier: BSD-3-Clause
#include "detector/detector_node.hpp"

#include <cmath>
#include <utility>

#include "detection/edge_offset.hpp"
#include "geometry/angles.hpp"
#include "pose/make_localiser.hpp"
#include "text/number_text.hpp"

namespace orchard::procs {
namespace {

/// Whether the rig's wheels are heard: by the detector itself, or by who tells its poses.
bool has_wheels(const io::Config& config) {
  const auto odometry = static_cast<std::size_t>(pose::MeasurementKind::kOdometry);
  return config.detector.use_odometry ||
         pose::expected_measurements(config.pose)[odometry].has_value();
}

}  // namespace

DetectorNode::DetectorNode(const io::Config& config)
    : rig_(config.laser, config.camera, config.detector),
      pairer_(config.detector.pairing_tolerance_s, config.detector.image_wait_s,
              config.detector.use_odometry, config.camera.delay_s),
      monitor_(config.detector.extrinsics_monitor, config.camera.intrinsics.fc_px[0]),
      edge_reach_px_(config.camera.intrinsics.fc_px[0] *
                     std::tan(detection::kSearchWindow_deg * geometry::kPi / 180.0)),
      has_wheels_(has_wheels(config)),
      health_(config) {
  if (config.detector.adaptation.enabled && rig_.has_camera) {
    adaptation_.emplace(config.detector.adaptation, config.detector.width.mean_m);
  }
  if (config.laser_rear.enabled) {
    rear_rig_.emplace(config.laser_rear, config.camera, config.detector);
    joiner_.emplace(config.laser, config.detector.image_wait_s, has_wheels_);
  }
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
      return send_result(detection::detect(*scan, nullptr, rig_), detection::turn_us(*scan), send);
    }
    findings_.push_back({detection::find_by_laser(*scan, rig_), width_model_});
    pairs = pairer_.add(*scan);
  } else if (const auto* image = std::get_if<vision::Image>(&input)) {
    if (rig_.has_camera) pairs = pairer_.add(*image);
  } else if (const auto* rear = std::get_if<laser::RearScan>(&input)) {
    if (!joiner_) return;
    health_.note_rear_scan(*rear);
    return send_views(joiner_->add_rear(detection::detect(*rear, nullptr, *rear_rig_).detections),
                      send);
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
    return "SCAN waits for intensities: detector.segmentation.reflector needs them and the laser "
           "driver sends none; switch them on there or set reflector to ignored";
  }
  if (const auto view = joiner_ ? joiner_->waiting_utime() : std::nullopt) {
    return "SCAN at " + fixed_text(static_cast<double>(*view) * 1e-6, 3) +
           " s waits for SCAN.rear of that time or later (from the second laser driver)";
  }
  const auto utime = pairer_.waiting_scan_utime();
  if (!utime) return {};
  return "SCAN at " + fixed_text(static_cast<double>(*utime) * 1e-6, 3) + " s waits for an IMAGE" +
         (rig_.detector.use_odometry ? " (from the camera driver) and ODOMETRY (from the base)"
                                     : " (from the camera driver)");
}

std::string DetectorNode::warning() const {
  const std::string text = ended_ ? monitor_.whole_run() : monitor_.warning();
  const std::string inputs = health_.text(ended_, pairer_.num_without_motion());
  return text + (text.empty() || inputs.empty() ? "" : "; ") + inputs;
}

/// Looks for itself, more widely than the detector: what it finds never reaches DETECTIONS.
void DetectorNode::compare_edges(const detection::LaserFindings& findings,
                                 const detection::ScanImagePair& pair,
                                 vision::PictureReader& picture) {
  if (!monitor_.is_due(pair.scan.utime)) return;
  std::vector<double> offsets_px;
  for (const auto& seen :
       detection::look_for_edges(findings, picture, rig_, pair.motion, edge_reach_px_)) {
    offsets_px.push_back(seen.offsets.front().middle_px());
  }
  monitor_.add(pair.scan.utime, offsets_px);
}

void DetectorNode::send_detections(const detection::ScanImagePair& pair, const bus::Outbox& send) {
  Findings findings = std::move(findings_.front());
  findings_.pop_front();
  // The scans before this one have moved the width since it came: judge it by where they led, as
  // if it had come after them.
  if (findings.width_model != width_model_) {
    findings.laser = detection::find_by_laser(pair.scan, rig_);
  }
  std::optional<vision::PictureReader> picture;
  if (pair.image) {
    picture.emplace(*pair.image);
    health_.note_picture(rig_.detector.use_odometry && !pair.motion);
    compare_edges(findings.laser, pair, *picture);
  } else {
    health_.note_no_picture();
  }
  detection::DetectResult result = detection::judge_by_camera(
      std::move(findings.laser), picture ? &*picture : nullptr, rig_, pair.motion);
  if (result.image_needed) health_.note_looked_at(picture->image(), !result.image_unusable);
  const std::int64_t utime = result.detections.utime;
  const auto looks = std::move(result.looks);
  send_result(std::move(result), detection::turn_us(pair.scan), send);
  adapt(utime, looks, send);
}

void DetectorNode::adapt(std::int64_t utime, const std::vector<detection::AdaptationLook>& looks,
                         const bus::Outbox& send) {
  if (!adaptation_) return;
  const auto steps = adaptation_->add(utime, looks);
  if (steps.empty()) return;
  const detection::AdaptedModel& model = adaptation_->model();
  if (rig_.detector.width.mean_m != model.width_mean_m) ++width_model_;
  rig_.detector.width.mean_m = model.width_mean_m;
  rig_.light_gains = detection::undoing(model.light);
  for (const auto& step : steps) send(step);
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
