// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/pose2.hpp"

namespace orchard::evaluation {

/// A pose T_map_base with its time.
struct TrackPose {
  std::int64_t utime = 0;  ///< [us]
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;  ///< 0 in a track without headings
};

/// Poses in order of utime.
struct Track {
  std::vector<TrackPose> poses;
  bool has_yaw = true;  ///< false: positions only
};

/// Alignment of the estimate before the comparison.
enum class Alignment {
  kNone,
  kRigid,   ///< least-squares rotation and translation (Umeyama 1991, without scale)
  kOrigin,  ///< its first compared pose is made equal to the true one
};

/// Rules of a trajectory evaluation; the defaults of RPE are those of evo.
struct TrajectoryRules {
  Alignment alignment = Alignment::kNone;
  std::optional<double> gap_max_s;  ///< no interpolation between true poses farther apart; none:
                                    ///< three median intervals
  double delta_m = 1.0;             ///< of RPE: length of a segment, along the estimate
};

/// Statistics of a set of errors; all 0 for an empty set.
struct ErrorStatistics {
  int num = 0;
  double rmse = 0.0;
  double mean = 0.0;
  double median = 0.0;
  double sd = 0.0;  ///< over N, like numpy's std
  double min = 0.0;
  double max = 0.0;
};

ErrorStatistics error_statistics(std::vector<double> errors);

/// One estimate and the true pose at its time, interpolated.
struct ComparedPose {
  std::int64_t utime = 0;
  TrackPose estimate;  ///< after alignment
  TrackPose truth;
  double way_m = 0.0;  ///< true path length since the first compared pose
  double position_error_m = 0.0;
  double yaw_error_rad = 0.0;  ///< signed, estimate minus truth; 0 without headings
};

/// Evaluation of a trajectory against the truth.
struct TrajectoryEvaluation {
  int num_estimates = 0;
  int num_true = 0;
  int num_outside = 0;  ///< estimates before the first or after the last true pose
  int num_in_gaps = 0;  ///< estimates inside a gap of the truth
  double gap_max_s = 0.0;
  geometry::Pose2 T_truth_estimate;  ///< the alignment, from the estimate's frame to the truth's
  bool has_yaw = true;               ///< of the truth
  std::vector<ComparedPose> compared;
  ErrorStatistics position_m;  ///< APE, translation part (ATE)
  ErrorStatistics yaw_rad;     ///< APE, rotation
  /// RPE, translation: that of the difference between the two motions; without headings the
  /// difference of the two distances (evo's point distance).
  ErrorStatistics relative_position_m;
  ErrorStatistics relative_yaw_rad;
};

/// Computes absolute and relative errors as evo does (Grupp; Sturm et al. 2012), in the plane.
/// Throws std::invalid_argument for tracks whose time does not increase, and for rules that are not
/// positive. With too few poses a statistic is 0, with num 0.
TrajectoryEvaluation evaluate_trajectory(const Track& estimate, const Track& truth,
                                         const TrajectoryRules& rules);

/// The evaluation as a few lines for the user; metres and degrees.
std::string trajectory_summary(const TrajectoryEvaluation& evaluation,
                               const TrajectoryRules& rules);

/// The evaluation as one JSON object; metres and radians.
std::string trajectory_json(const TrajectoryEvaluation& evaluation, const TrajectoryRules& rules);

}  // namespace orchard::evaluation
