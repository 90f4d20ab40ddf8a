// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "bus/node/node.hpp"
#include "detection/adaptation/adaptation.hpp"
#include "detection/consistency_monitor.hpp"
#include "detection/detect.hpp"
#include "detection/rear_joiner.hpp"
#include "detection/rig.hpp"
#include "detection/scan_image_pairer.hpp"
#include "detector/detection_precomputer.hpp"
#include "detector/input_health.hpp"
#include "detector/judged_pair.hpp"
#include "io/config/config.hpp"

namespace orchard::procs {

/// Detects trunks: SCAN and IMAGE in, DETECTIONS out, one message per scan in order of the scans.
///
/// Without a camera in the rig each scan is answered at once. With a camera, a scan is segmented on
/// arrival, to leave less work for later, and waits for its picture; if none arrives in time, its
/// trunk candidates are UNSEEN. With detector.use_odometry it also waits for the ODOMETRY at the
/// picture's time, to compensate the motion between the two; if none arrives within image_wait_s,
/// the pair is used without it, and warning() says so. warning() also reports other faults of the
/// inputs (InputHealth) and a lasting disagreement of laser and image edges
/// (detector.extrinsics_monitor).
///
/// With detector.adaptation.enabled each scan is classified with the models adapted from the scans
/// before it, in whatever order the channels arrive; ADAPTATION reports each change.
///
/// With laser_rear.enabled the detections of SCAN.rear are joined with those of SCAN into one
/// message; odometry, where the rig has it, compensates the motion between the two scans.
class DetectorNode : public bus::Node {
 public:
  explicit DetectorNode(const io::Config& config);
  DetectorNode(const DetectorNode&) = delete;  // precomputer_ refers to its rigs
  DetectorNode& operator=(const DetectorNode&) = delete;

  std::string_view name() const override { return "detector"; }
  std::vector<bus::Channel> inputs() const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  std::unique_ptr<bus::Precomputation> precompute(const bus::Message& input) override;
  void use_precomputed(std::unique_ptr<bus::Precomputation> precomputed) override;
  void flush(const bus::Outbox& send) override;
  bus::NodeCounts counts() const override;
  std::string waiting_for() const override;
  std::string warning() const override;

 private:
  /// Laser findings of a scan and the version of the width model they were made with; without
  /// findings when they were computed ahead of their turn.
  struct Findings {
    std::optional<detection::LaserFindings> laser;
    std::int64_t width_model = 0;
  };
  detection::DetectResult detect_alone(const laser::Scan& scan, const detection::Rig& rig);
  JudgedPair judge(const detection::ScanImagePair& pair);
  void send_detections(const detection::ScanImagePair& pair, const bus::Outbox& send);
  void adapt(std::int64_t utime, const std::vector<detection::AdaptationObservation>& observations,
             const bus::Outbox& send);
  void send_result(detection::DetectResult result, std::int64_t turn_us, const bus::Outbox& send);
  void send_views(std::vector<detection::Detections> views, const bus::Outbox& send);

  detection::Rig rig_;
  std::optional<detection::Rig> rear_rig_;  ///< the camera does not see its scans
  std::optional<detection::RearJoiner> joiner_;
  detection::ScanImagePairer pairer_;
  std::deque<Findings> findings_;  ///< one per scan in pairer_, in the same order
  std::optional<DetectionPrecomputer> precomputer_;
  std::unique_ptr<PrecomputedDetections> precomputed_;  ///< for the input being handled
  std::size_t num_precomputed_used_ = 0;                ///< pairs of precomputed_ used so far
  std::optional<detection::Adaptation> adaptation_;
  std::int64_t width_model_ = 0;  ///< version of the width model
  std::int32_t next_seq_ = 0;
  std::int64_t num_unusable_ = 0;     ///< unusable pictures, and scans without intensities
  bool intensities_missing_ = false;  ///< of the newest scan answered
  detection::ConsistencyMonitor monitor_;
  double edge_reach_px_;
  bool has_wheels_;
  InputHealth health_;
  bool ended_ = false;
};

}  // namespace orchard::procs
