// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/node/levelled_inputs.hpp"
#include "bus/node/node.hpp"
#include "detection/camera_check.hpp"
#include "detection/detect.hpp"
#include "detection/rear_joiner.hpp"
#include "detection/rig.hpp"
#include "detection/scan_image_pairer.hpp"
#include "io/config/config.hpp"
#include "laser/own_returns.hpp"
#include "laser/range_noise.hpp"
#include "laser/scan.hpp"
#include "vision/image.hpp"

namespace orchard::procs {

/// Diagnoses a detector's inputs as text for the user: no picture arrives, none is usable, ODOMETRY
/// is missing, scans show the robot itself. Changes no output.
class InputHealth {
 public:
  explicit InputHealth(const io::Config& config);

  void note_scan(const laser::Scan& scan) { own_returns_.add(scan); }
  std::optional<laser::OwnReturn> own_returns() const { return own_returns_.found(); }
  void note_rear_scan(const laser::Scan& scan) { rear_own_returns_.add(scan); }
  /// Notes a scan that was answered without a picture.
  void note_no_picture();
  /// Notes a scan that was answered with a picture. `without_motion`: motion was required and none
  /// was available.
  void note_picture(bool without_motion);
  /// Notes whether a picture that was needed was usable.
  void note_needed_picture(const vision::Image& image, bool is_usable);

  /// The current faults; with `ended` those of the whole run. `num_without_motion`: pictures used
  /// without motion so far.
  std::string text(bool ended, std::int64_t num_without_motion) const;

 private:
  std::string picture_text(bool ended) const;
  std::string unusable_text(bool ended) const;
  std::string odometry_text(bool ended, std::int64_t num_without_motion) const;

  bool has_camera_;
  std::int32_t width_px_;
  std::int32_t height_px_;
  laser::OwnReturns own_returns_;
  laser::OwnReturns rear_own_returns_;
  std::int64_t num_pictures_ = 0;         ///< pictures paired with a scan
  std::int64_t num_without_picture_ = 0;  ///< scans without a picture
  std::int64_t num_since_picture_ = 0;    ///< scans without a picture since the last one with
  bool last_without_motion_ = false;      ///< the newest pair had no motion, although required
  std::int64_t num_usable_ = 0;           ///< usable ones among the needed pictures
  std::int64_t num_unusable_ = 0;
  std::int64_t num_since_usable_ = 0;
  std::int32_t bad_width_px_ = 0;  ///< size of the newest unusable picture
  std::int32_t bad_height_px_ = 0;
};

/// Detections of a scan and its picture.
struct JudgedPair {
  detection::DetectResult result;
  std::optional<detection::CameraSight> sight;  ///< for CameraCheck; none when not asked for
};

/// Classifies the laser findings of a scan with its picture. A pure function. `wants_sight` has no
/// effect on the detections.
JudgedPair judge_pair(detection::LaserFindings findings, const detection::ScanImagePair& pair,
                      const detection::Rig& rig, bool wants_sight);

/// The detector's results for one input, computed ahead of its turn.
class PrecomputedDetections : public bus::Precomputation {
 public:
  void compute() override;

  /// The picture, if the input is one that is paired.
  std::shared_ptr<const vision::Image> image;
  /// The result for a scan without a camera; none for any other input.
  std::optional<detection::DetectResult> alone;
  /// The scan-image pairs completed by the input, in order.
  struct Pair {
    detection::ScanImagePair pair;
    bool wants_sight;
    JudgedPair judged;

    /// True if this is the pair and the wish that the detector itself arrived at.
    bool is_of(const detection::ScanImagePair& other, bool other_wants_sight) const;
  };
  std::vector<Pair> pairs;

 private:
  friend class DetectionPrecomputer;
  const detection::Rig* rig_ = nullptr;
  const laser::Scan* scan_alone_ = nullptr;
};

/// Predicts the detector's work from the inputs alone: the pairing of scans with pictures and
/// motions depends on nothing else, and neither do the results.
class DetectionPrecomputer {
 public:
  /// Both rigs must outlive this object and its results; `rear_rig` may be null.
  DetectionPrecomputer(const io::Config& config, const detection::Rig& rig,
                       const detection::Rig* rear_rig);

  /// Takes the inputs in order. Every scan gives a result.
  std::unique_ptr<PrecomputedDetections> precompute(const bus::Message& input);

 private:
  const detection::Rig& rig_;
  const detection::Rig* rear_rig_;
  detection::ScanImagePairer pairer_;
  detection::LookTimes look_times_;
};

/// Makes the pairer of scans and pictures for a configuration.
detection::ScanImagePairer make_pairer(const io::Config& config);

/// Detects trunks: SCAN and IMAGE in, DETECTIONS out, one message per scan in order of the scans.
///
/// Without a camera in the rig each scan is answered at once. With a camera, a scan is segmented on
/// arrival, to leave less work for later, and waits for its picture; if none arrives in time, its
/// trunk candidates are UNSEEN. With detector.use_odometry it also waits for the ODOMETRY at the
/// picture's time, to compensate the motion between the two; if none arrives within image_wait_s,
/// the pair is used without it, and warning() says so. warning() also reports other faults of the
/// inputs (InputHealth). findings() are those of CameraCheck and of the ranges' noise.
///
/// With laser_rear.enabled the detections of SCAN.rear are joined with those of SCAN into one
/// message; odometry, where the rig has it, compensates the motion between the two scans.
///
/// With laser.height_m the scans are levelled by the IMU first; the windows of a picture follow the
/// roll and pitch at its scan.
class DetectorNode : public bus::Node {
 public:
  explicit DetectorNode(const io::Config& config);
  DetectorNode(const DetectorNode&) = delete;  // precomputer_ refers to its rigs
  DetectorNode& operator=(const DetectorNode&) = delete;

  std::string_view name() const override { return "detector"; }
  std::vector<bus::Channel> inputs() const override;
  bus::InputNeed need_of(bus::Channel channel) const override;
  void handle(const bus::Message& input, const bus::Outbox& send) override;
  std::unique_ptr<bus::Precomputation> precompute(const bus::Message& input) override;
  void use_precomputed(std::unique_ptr<bus::Precomputation> precomputed) override;
  void flush(const bus::Outbox& send) override;
  bus::NodeCounts counts() const override;
  std::string waiting_for() const override;
  std::string warning() const override;
  std::vector<Finding> findings() const override;
  /// What of the robot the front scanner sees; none if nothing.
  std::optional<laser::OwnReturn> own_returns() const { return health_.own_returns(); }
  /// Noise of a range over what the rig states; none if not seen.
  std::optional<double> range_noise_ratio() const { return range_noise_.ratio(); }

 private:
  bool compensates_motion() const;
  void use(const bus::Message& input, const bus::Outbox& send);
  detection::DetectResult detect_alone(const laser::Scan& scan, const detection::Rig& rig);
  JudgedPair judge(const detection::ScanImagePair& pair);
  void send_detections(const detection::ScanImagePair& pair, const bus::Outbox& send);
  void send_result(detection::DetectResult result, std::int64_t turn_us, const bus::Outbox& send);
  void send_views(std::vector<detection::Detections> views, const bus::Outbox& send);

  bus::LevelledInputs levelled_;
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
  detection::LookTimes look_times_;
  detection::CameraCheck camera_check_;
  InputHealth health_;
  laser::RangeNoise range_noise_;
  bool ended_ = false;
};

}  // namespace orchard::procs
