// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "bus/node/node.hpp"
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
  detection::DetectResult detect_alone(const laser::Scan& scan, const detection::Rig& rig);
  JudgedPair judge(const detection::ScanImagePair& pair);
  void send_detections(const detection::ScanImagePair& pair, const bus::Outbox& send);
  void send_result(detection::DetectResult result, std::int64_t turn_us, const bus::Outbox& send);
  void send_views(std::vector<detection::Detections> views, const bus::Outbox& send);

  detection::Rig rig_;
  std::optional<detection::Rig> rear_rig_;  ///< the camera does not see its scans
  std::optional<detection::RearJoiner> joiner_;
  detection::ScanImagePairer pairer_;
  /// One per scan in pairer_, in the same order; none when computed ahead of its turn.
  std::deque<std::optional<detection::LaserFindings>> findings_;
  std::optional<DetectionPrecomputer> precomputer_;
  std::unique_ptr<PrecomputedDetections> precomputed_;  ///< for the input being handled
  std::size_t num_precomputed_used_ = 0;                ///< pairs of precomputed_ used so far
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
