// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/trajectory_evaluation.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::evaluation {

/// What a localisation says of itself. Unconfirmed: with a pose, by a stated start that the trunks
/// around do not tell from other places.
enum class PlaceState { kLost, kAmbiguous, kUnconfirmed, kPlaced };

/// From utime on, until the next one.
struct PlaceStateChange {
  std::int64_t utime = 0;
  PlaceState state = PlaceState::kLost;
};

/// A localisation that ran beside a drive without steering it.
struct ShadowRun {
  std::vector<pose::PoseEstimate> poses;  ///< as published, in order of utime; none while lost
  std::vector<PlaceStateChange> states;   ///< in order of utime
};

/// A moment of the drive, at a true pose.
struct ShadowMoment {
  double time_s = 0.0;  ///< since the first true pose
  double way_m = 0.0;   ///< true way since then
  PlaceState state = PlaceState::kLost;
  std::optional<double> error_m;  ///< of the position; none without a pose
  double sd_m = 0.0;              ///< claimed, on the longer axis
};

/// How much of a drive was driven within an error.
struct DrivenWithin {
  double limit_m = 0.0;
  double time_s = 0.0, way_m = 0.0;         ///< in all
  double longest_s = 0.0, longest_m = 0.0;  ///< without a break
};

/// A localisation against the truth: how far the robot could have driven by it.
///
/// Each step between two true poses counts with its time and way for the state, and the error, at
/// its end; gaps of the truth of more than 10 s count for nothing.
struct LocalisationEvaluation {
  std::vector<ShadowMoment> moments;      ///< at the true poses
  double time_s = 0.0, way_m = 0.0;       ///< of the drive
  double placed_s = 0.0, placed_m = 0.0;  ///< with a pose
  double lost_s = 0.0, ambiguous_s = 0.0, unconfirmed_s = 0.0;
  std::optional<double> first_s, first_m;  ///< until the first pose
  ErrorStatistics position_m, yaw_rad;     ///< where there is a pose; yaw only if the truth has it
  std::array<DrivenWithin, 3> within;      ///< 0.1, 0.3 and 0.5 m
  /// Placed, off by more than 0.5 m and by more than is claimed (99.73 %): wrong without a warning.
  double wrong_s = 0.0, wrong_m = 0.0, wrong_longest_s = 0.0;
  double sd_m = 0.0;        ///< claimed, root mean square over both axes together
  double nees = 0.0;        ///< mean normalised error squared of (x, y): 2 if the claims are true
  double nees_share = 0.0;  ///< share within the bound of 95 %
};

/// Judges a shadow run by true poses in the map's frame, whose positions have a standard deviation
/// of truth_sd_m on each axis. Throws std::invalid_argument for times that do not increase, fewer
/// than two true poses, and a negative standard deviation.
LocalisationEvaluation evaluate_localisation(const ShadowRun& run, const Track& truth,
                                             double truth_sd_m);

/// The evaluation as a few lines for the user.
std::string localisation_summary(const LocalisationEvaluation& evaluation);

/// The evaluation as one JSON object, without the moments; metres, seconds, radians.
std::string localisation_json(const LocalisationEvaluation& evaluation);

/// The moments as a table: `time_s,way_m,state,error_m,sd_m`; error and sd are empty without a
/// pose.
std::string localisation_csv(const LocalisationEvaluation& evaluation);

}  // namespace orchard::evaluation
