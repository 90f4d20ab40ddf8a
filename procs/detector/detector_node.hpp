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
#include "detector/foresight.hpp"
#include "detector/input_health.hpp"
#include "detector/judged_pair.hpp"
#include "io/config/config.hpp"

namespace orchard::procs {

/// SCAN and IMAGE in, DETECTIONS out: one message per scan, in order of the scans.
///
/// A rig without a camera answers each scan at once. With a camera a scan is cut into objects as it
/// comes, so that less is left to do once its picture is there, and waits for its picture;
/// without one in time its trunk candidates are UNSEEN. With detector.use_odometry it waits for the
/// ODOMETRY at the picture's time too, to account for the motion between the two; where none comes
/// within image_wait_s the pair is used without it, and warning() says so. Warns too of what else
/// is wrong with its inputs (InputHealth), and when laser and image edges disagree for long
/// (detector.extrinsics_monitor). With detector.adaptation.enabled each scan is judged by the
/// models that the scans before it have led to, whatever order the channels arrive in, and
/// ADAPTATION says what became of them.
/// With laser_rear.enabled what SCAN.rear shows joins what SCAN shows, in one message for both; the
/// wheels, where the rig has them, undo what it drove between the two.
class DetectorNode : public bus::Node {
 public:
  explicit DetectorNode(const io::Config& config);
  DetectorNode(const DetectorNode&) = delete;  // what looks ahead refers to its rigs
  DetectorNode& operator=(const DetectorNode&) = delete;

  std::string_view name() const override { return "detector"; }
  std::vector<bus::Channel> inputs() const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  std::unique_ptr<bus::Foreseen> foresee(const bus::Message& input) override;
  void expect(std::unique_ptr<bus::Foreseen> foreseen) override;
  void flush(const bus::Outbox& send) override;
  bus::NodeCounts counts() const override;
  std::string waiting_for() const override;
  std::string warning() const override;

 private:
  /// A scan's laser half, and which state of the width model it was made with; none of a scan that
  /// was judged ahead of its turn.
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
  std::optional<detection::Rig> rear_rig_;  ///< its camera sees nothing of it
  std::optional<detection::RearJoiner> joiner_;
  detection::ScanImagePairer pairer_;
  std::deque<Findings> findings_;  ///< of the scans in pairer_, in its order
  std::optional<Foresight> foresight_;
  std::unique_ptr<ForeseenDetections> foreseen_;  ///< of the input that is handled
  std::size_t num_foreseen_used_ = 0;             ///< of its pairs
  std::optional<detection::Adaptation> adaptation_;
  std::int64_t width_model_ = 0;  ///< +1 with every change of the width model
  std::int32_t next_seq_ = 0;
  std::int64_t num_unusable_ = 0;     ///< pictures, and scans without the intensities wanted
  bool intensities_missing_ = false;  ///< of the newest scan answered
  detection::ConsistencyMonitor monitor_;
  double edge_reach_px_;
  bool has_wheels_;
  InputHealth health_;
  bool ended_ = false;
};

}  // namespace orchard::procs
