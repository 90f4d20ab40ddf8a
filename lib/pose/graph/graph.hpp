// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pose/graph/record_store.hpp"
#include "pose/motion.hpp"

namespace orchard::pose {

/// Sum of all observations of one landmark by the scans of one keyframe: its position in base at
/// the keyframe, in information form.
struct SlamObservation {
  int landmark = -1;
  int num_scans = 0;
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();    ///< sum of inverse covariances
  Eigen::Vector2d information_m = Eigen::Vector2d::Zero();  ///< sum of information * position
  double floor_sd_m = 0.0;  ///< systematic error, common to all scans of a keyframe

  Eigen::Vector2d position() const;
  Eigen::Matrix2d covariance() const;
};

/// Storage of the observations of older keyframes.
using SlamObservationStore = RecordStore<SlamObservation>;

/// Observations of a keyframe, copy-on-write: after keep(), copies of the list share the stored
/// rows, and edit() makes an own copy on the heap.
class ObservationList {
 public:
  const SlamObservation* begin() const {
    if (memory_ == nullptr) return own_.data();
    memory_->use(kept_);
    return kept_.first;
  }
  const SlamObservation* end() const { return begin() + size(); }
  std::size_t size() const { return memory_ != nullptr ? kept_.num_rows : own_.size(); }
  bool empty() const { return size() == 0; }
  const SlamObservation& operator[](std::size_t i) const { return begin()[i]; }

  /// Returns the list for modification.
  std::vector<SlamObservation>& edit();

  /// Moves the rows to `memory`, which must outlive this list and its copies.
  void keep(SlamObservationStore& memory);

 private:
  std::vector<SlamObservation> own_;
  const SlamObservationStore* memory_ = nullptr;  ///< that stores the rows; null: own_
  SlamObservationStore::Place kept_;
};

/// Position of a landmark in map by several observations, in information form.
struct PositionSum {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();    ///< sum of inverse covariances
  Eigen::Vector2d information_m = Eigen::Vector2d::Zero();  ///< sum of information * position
};

/// Cache of the sums of landmarks' observations by keyframes before the window: no scan changes
/// these keyframes any more, only a solve of the whole graph, after which the cache is emptied.
class OlderSums {
 public:
  struct Sum : PositionSum {
    std::size_t num_keyframes = 0;  ///< that are in the sum: the first of SlamLandmark::keyframes
  };

  /// Sets the first keyframe of the window. One before the last value empties the cache.
  void start(int first) {
    if (first < first_) forget();
    first_ = first;
  }

  /// First keyframe that belongs to no sum.
  int first() const { return first_; }

  /// Returns the sum of a landmark, to be extended by its keyframes before first().
  Sum& of(int landmark) {
    if (sums_.size() >= kSumsMax) sums_.clear();
    return sums_[landmark];
  }

  void forget() { sums_.clear(); }
  void forget(int landmark) { sums_.erase(landmark); }

 private:
  /// derived: more than are in the local map; memory must not grow with the drive.
  static constexpr std::size_t kSumsMax = 1024;

  int first_ = 0;
  std::unordered_map<int, Sum> sums_;
};

/// Measured position in map of a point on base (given by its lever arm), optionally with heading.
struct AbsolutePosition {
  std::int64_t utime = 0;
  Eigen::Vector3d T_keyframe_then = Eigen::Vector3d::Zero();  ///< motion from keyframe to `utime`
  Eigen::Vector2d lever_base_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  bool has_yaw = false;
  double yaw_rad = 0.0;
  double yaw_sd_rad = 1.0;
  bool is_gnss = false;       ///< by GNSS: shares the receiver's correlated error
  bool is_displaced = false;  ///< e.g. by reflected signals: left out
  int receiver_error = -1;    ///< index in SlamGraph::receiver_errors
};

/// Correlated error of a satellite receiver, common to all its fixes of a short time.
struct ReceiverError {
  std::int64_t utime = 0;  ///< of the first of these fixes
  Eigen::Vector2d p_m = Eigen::Vector2d::Zero();
  double claimed_variance = 0.0;  ///< of the first fix, per axis [m2]
};

/// Composition of a receiver's errors, relative to its claimed variance.
struct ReceiverModel {
  double correlated = 0.0;                  ///< variance of the time-correlated error
  double noise = 1.0;                       ///< variance of the white noise of each fix
  double claimed_correlated = 0.0;          ///< `correlated` if the claimed variance is true
  std::optional<double> learnt_correlated;  ///< the same by the last whole solve
};

/// A pose of the robot in the graph, with its measurements.
struct Keyframe {
  std::int64_t utime = 0;
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  /// Covariance of T_map_base in map [m, m, rad], from the last whole solve or composed since.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Cross-covariance of T_map_base (rows) with the odometry calibration, and covariance of the
  /// calibration: wheel errors persist, so later motion is correlated with earlier motion.
  Eigen::Matrix3d calibration_cross = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d calibration_covariance = Eigen::Matrix3d::Zero();
  /// Covariance of T_map_base relative to the landmarks around it, when it was the newest keyframe.
  Eigen::Matrix3d local_covariance = Eigen::Matrix3d::Zero();
  RelativeMotion motion;  ///< from the previous keyframe
  double travel_m = 0.0;  ///< path length since the start
  int calibration = 0;    ///< index of the odometry calibration of `motion`
  ObservationList observations;
  std::vector<AbsolutePosition> positions;
};

/// An object that may be observed more than once.
struct SlamLandmark {
  Eigen::Vector2d p_map = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< of p_map, given the poses
  double width_m = 0.0;                                   ///< mean of its observations
  double width_information = 0.0;                         ///< sum of inverse variances
  std::vector<int> keyframes;                             ///< that observed it, ascending
  double seen_m = 0.0;                                    ///< max range at which it was observed
  int num_misses = 0;  ///< keyframes that should have observed it and did not
  bool alive = true;   ///< false: dropped, or merged into another
  bool confirmed = false;

  /// Returns the covariance of p_map, given the poses that observed it, plus a minimum.
  Eigen::Matrix2d covariance() const;

  /// Returns the standard deviation of the mean width [m]; 1 m before the first observation.
  double width_sd_m() const;

  /// Adds one scan's width to the mean.
  void add_width(double observed_m, double sd_m);
};

/// Relative pose of two keyframes, measured by matching their scans.
struct RelativePose {
  int from = 0;
  int to = 0;  ///< the later one
  Eigen::Vector3d T_from_to = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of T_from_to
};

/// What a merge of two landmarks replaced.
struct LandmarkMerge {
  int from = 0;
  int into = 0;
  SlamLandmark from_was;
  SlamLandmark into_was;
  std::vector<ObservationList> observations_were;  ///< of the keyframes of `from_was`
};

/// The SLAM graph: poses, landmarks and the measurements between them. Indices are stable: nothing
/// is renumbered.
struct SlamGraph {
  std::vector<Keyframe> keyframes;
  std::vector<SlamLandmark> landmarks;
  std::vector<OdometryCalibration> calibrations;
  /// Standard deviations of the calibration's change per interval, learnt from the drive.
  Eigen::Vector3d calibration_walk_sd = Eigen::Vector3d::Zero();
  std::vector<ReceiverError> receiver_errors;
  ReceiverModel receiver;
  double observation_noise = 1.0;  ///< variance of observations over what they claim, learnt
  std::vector<RelativePose> relative_poses;      ///< ascending by `to`
  std::shared_ptr<SlamObservationStore> memory;  ///< stores old observations; null: the heap
  OlderSums older;
  std::optional<std::vector<LandmarkMerge>> merges;  ///< for undo_merges(); none: not recorded
  bool georeferenced = false;  ///< by absolute positions; else the first keyframe is the origin

  /// Adds one scan's observation of a landmark to those of a keyframe.
  void add_observation(int keyframe, int landmark, const Eigen::Vector2d& p_base,
                       const Eigen::Matrix2d& covariance, double floor_sd_m);

  /// Drops the newest keyframe's observations from fewer than `num_scans` scans as clutter.
  void drop_rare_observations(double num_scans);

  /// Drops a landmark and all observations of it.
  void drop(int landmark);

  /// Merges `landmark` into another: its observations become those of `into`.
  void merge(int landmark, int into);

  /// Undoes the recorded merges. Positions of landmarks are those of before the merges.
  void undo_merges();

  /// Returns true if one keyframe observed both landmarks: then they are two objects.
  bool co_observed(int a, int b) const;

  /// Returns the sum of a landmark's observations by keyframes before older.first(), in map, given
  /// the poses. Whoever changes an older pose calls older.forget().
  const OlderSums::Sum& older_sum(int landmark);

  /// Recomputes a landmark's information, and optionally its position, from all its observations,
  /// given the poses.
  void update_landmark(int landmark, bool update_position);

  /// Updates many landmarks in one pass over the keyframes, with results identical to
  /// update_landmark(). kPosition includes kInformation.
  enum class Update : char { kNone, kInformation, kPosition };
  void update_landmarks(const std::vector<Update>& updates);
};

}  // namespace orchard::pose
