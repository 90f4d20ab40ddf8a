// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

// When a position in a prior map is accepted, judged again and given up.

/// Travel between two searches, and between two checks of a position that was found [m].
inline constexpr double kSearchEvery_m = 1.0;

/// Constellations of fewer trunks repeat in an orchard and are not searched for.
inline constexpr int kTrunksMin = 6;

/// Hypotheses scored at each scan: bounds its cost.
inline constexpr int kHypothesesPerScan = 400;

/// Natural log odds of one position against all others together at which it is accepted (1 in
/// 8,000), and at which it takes the place of one that is held.
inline constexpr double kLogOddsMin = 9.0;

/// Natural log likelihood ratio against another orchard of such rows at which a position is
/// accepted.
inline constexpr double kLogFitMin = 0.0;

/// When fewer of the expected trees are observed, the position is given up.
inline constexpr double kLostFraction = 0.5;

/// When more of them are, trunks around that fit badly are no reason by themselves: another
/// position must explain them better.
inline constexpr double kThereFraction = 0.8;

/// A position with a larger standard deviation is lost [m]; see also kLostSpacings.
inline constexpr double kLostSd_m = 1.0;

/// A place dead-reckoned to more than this fraction of the trees' spacing may be a tree off.
inline constexpr double kLostSpacings = 0.3;

inline constexpr int kJudgedTrees = 4;  ///< fewer say nothing of the place

/// Checks in a row that speak against a place.
inline constexpr int kContradictions = 2;

/// A place that is held is judged by what stands and was seen within so many ranges of sight.
inline constexpr double kAroundRanges = 1.5;

}  // namespace orchard::pose
