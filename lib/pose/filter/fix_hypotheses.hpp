// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pose/filter/fusion_filter.hpp"
#include "pose/graph/graph.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::pose {

/// Time in which positions of one source were displaced, e.g. by reflected signals.
struct DisplacedTime {
  std::int64_t begin_utime = 0;
  std::int64_t end_utime = 0;  ///< of the last displaced position
  bool is_gnss = true;

  friend bool operator==(const DisplacedTime& a, const DisplacedTime& b) {
    return a.begin_utime == b.begin_utime && a.end_utime == b.end_utime && a.is_gnss == b.is_gnss;
  }
};

/// One account of when positions were displaced.
struct DisplacementHistory {
  double probability = 1.0;
  std::vector<DisplacedTime> displaced;  ///< ascending
};

/// The credible histories that led to one and the same present.
///
/// What comes later cannot tell them apart, so that their probabilities stay as they are.
class DisplacementHistories {
 public:
  /// Returns all, the likeliest first; their probabilities sum to 1.
  const std::vector<DisplacementHistory>& all() const { return all_; }

  const std::vector<DisplacedTime>& likeliest() const { return all_.front().displaced; }

  /// Begins a displaced time in every history.
  void begin(std::int64_t utime, bool is_gnss);

  /// Extends the newest displaced time of every history; each must have one.
  void extend(std::int64_t utime);

  /// Takes in the histories of another account of the same present, with the odds of that against
  /// this.
  void merge(const DisplacementHistories& other, double odds);

 private:
  std::vector<DisplacementHistory> all_{DisplacementHistory{}};
};

/// Bank of filters, one for each credible history of which positions were displaced.
///
/// A position is direct or displaced by an unknown constant; a Markov chain switches between both.
/// With each position every history branches, and the likeliest are kept, so that later positions
/// decide about earlier ones. A further, unlikely branch is that the robot was moved or its wheels
/// slipped beyond what the filter models. How often positions are displaced is learnt by each
/// history. Source: Ackerson and Fu 1970, On state estimation in
/// switching environments. A heading that a gap made unknown is a sum of Gaussians, one hypothesis
/// each. Source: Alspach and Sorenson 1972, Nonlinear Bayesian estimation using Gaussian sums.
class FixHypotheses {
 public:
  struct Hypothesis {
    FusionFilter filter;
    double log_weight = 0.0;
    bool is_displaced = false;
    bool displaces_gnss = true;  ///< the source of the present displacement, if there is one
    DisplacementHistories histories;
    double travel_m = 0.0;  ///< since the last direct position
    double looks = 0.0;     ///< independent looks at whether positions are displaced
    double displaced_looks = 0.0;
  };

  explicit FixHypotheses(const FusionConfig& config);

  /// Returns the likeliest hypothesis.
  const Hypothesis& best() const { return all_.front(); }
  /// Returns its probability.
  double best_weight() const;

  /// All hypotheses, for changes that concern each; the likeliest first.
  std::vector<Hypothesis>& all() { return all_; }

  void move(const MotionStep& step);

  /// Starts at a first position, its heading unknown: direct or displaced, in several headings.
  void start(const PositionObservation& observation, std::int64_t utime);

  /// Adds the first pose: all positions until now were direct, or displaced by one constant.
  void place(const Eigen::Vector3d& x_y_yaw, const Eigen::Matrix3d& covariance, std::int64_t utime,
             bool is_gnss);

  /// Splits hypotheses whose heading is too uncertain to linearise, for fixes of this variance
  /// [m2], into several headings. Call before correct().
  void split_unknown_headings(double variance);

  void correct(const PositionObservation& observation, std::int64_t utime);

  /// Returns the credible histories of all hypotheses, the likeliest first.
  std::vector<DisplacementHistory> histories() const;

  /// Returns the pose of the likeliest, with the mean square deviation of all from it.
  PoseEstimate estimate(std::int64_t utime) const;

 private:
  std::vector<Hypothesis> all_;
  std::optional<std::int64_t> position_utime_;  ///< of the last position
  double travel_m_ = 0.0;                       ///< since then
};

/// Marks the positions within these times, ascending; all others are direct.
void mark_displaced(const std::vector<DisplacedTime>& displaced, SlamGraph& graph);

/// Marks the fixes of a georeferenced graph that are displaced, e.g. by reflected signals, by their
/// distances from its path: FixHypotheses decides, for a robot that stands at the constant distance
/// of the map from the receiver's frame. The path must err slowly compared with a displacement.
void mark_displaced_fixes(SlamGraph& graph);

}  // namespace orchard::pose
