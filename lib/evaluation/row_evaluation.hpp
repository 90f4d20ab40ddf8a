// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "evaluation/trajectory_evaluation.hpp"

namespace orchard::evaluation {

/// A row of a map or survey: the places of its trees in order along it [m].
using RowLine = std::vector<Eigen::Vector2d>;

/// Errors of a trajectory as seen from the rows between which the robot drives.
///
/// The aisle of a place is the space between the nearest row on either side; beside an outermost
/// row it is as wide as aisle_m. The headlands, before and behind the ends of the rows, are none.
struct RowEvaluation {
  int num_rows = 0;
  double aisle_m = 0.0;   ///< median distance of a row to its nearest neighbour
  int num_compared = 0;   ///< compared poses
  int num_in_aisles = 0;  ///< of these, with the true pose in an aisle; the next ones are of these
  int num_right_aisle = 0;       ///< estimate in the same aisle, or straight before or behind it
  double wrong_longest_s = 0.0;  ///< longest stay in another aisle, from its first pose to its last
  double wrong_longest_m = 0.0;  ///< the farthest true way in such a stay
  ErrorStatistics cross_track_m;  ///< part of the error across the true row, without its sign
  double cross_track_95_m = 0.0;  ///< 95 % of these are not above it
  /// As de Silva et al. 2026 (arXiv 2603.10847) count, over all compared poses: the nearest row is
  /// the one nearest to the true pose; entries into another one; distance of the estimate from the
  /// row nearest to the true pose, which is half an aisle for a robot that errs by nothing.
  int num_nearest_row = 0;
  int num_row_switches = 0;
  ErrorStatistics from_row_m;
  ErrorStatistics truth_from_row_m;  ///< the same distance of the true pose
};

/// Judges compared poses (evaluate_trajectory()) by rows in the frame of the truth. Throws
/// std::invalid_argument unless there are two rows or more, each of two places or more, finite.
RowEvaluation evaluate_rows(const std::vector<ComparedPose>& compared,
                            const std::vector<RowLine>& rows);

/// The evaluation as a few lines for the user; metres, seconds, percent.
std::string row_summary(const RowEvaluation& evaluation);

/// The evaluation as one JSON object; metres, seconds, shares from 0 to 1.
std::string row_json(const RowEvaluation& evaluation);

}  // namespace orchard::evaluation
