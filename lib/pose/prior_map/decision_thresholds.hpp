// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

// Thresholds for accepting, checking and giving up a position in a prior map.

/// Travel between two searches, and between two checks of the present position [m].
inline constexpr double kSearchInterval_m = 1.0;

/// Min number of trunks for a search; smaller constellations repeat in an orchard.
inline constexpr int kTrunksMin = 6;

/// Number of hypotheses scored per scan; bounds its cost.
inline constexpr int kHypothesesPerScan = 400;

/// Min natural log-odds of a position against all others together to be accepted (1 in 8,000), and
/// min log-likelihood advantage of a rival over the present position.
inline constexpr double kLogOddsMin = 9.0;

/// Min natural log-likelihood ratio of a position against another orchard with the same planting
/// pattern.
inline constexpr double kLogFitMin = 0.0;

/// If a smaller fraction of the expected trees is observed, the position is given up, unless the
/// trunks around support it.
inline constexpr double kLostFraction = 0.5;

/// If at least this fraction of the expected trees is observed, a bad fit of the trunks around is
/// not sufficient to give up the position: another one must explain them better.
inline constexpr double kDetectedFraction = 0.8;

/// A position with a larger standard deviation is lost [m]; see also kLostSpacings.
inline constexpr double kLostSd_m = 1.0;

/// Max standard deviation of a position as a fraction of the trees' spacing; beyond it, landmarks
/// may be confused with their neighbours.
inline constexpr double kLostSpacings = 0.3;

inline constexpr int kExpectedTreesMin = 4;  ///< min number of expected trees for a decision

/// Number of consecutive contradicting checks that end a position.
inline constexpr int kContradictionsMin = 2;

/// The present position is checked by trunks within this distance and travel, in detection ranges.
inline constexpr double kNearby_ranges = 1.5;

}  // namespace orchard::pose
