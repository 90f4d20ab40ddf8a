// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

// Numbers of this room that were chosen by trying; each block says on what.

// Sensor coverage learnt from detections; on the blocks of config/block.yaml (seeds 1001, 1) and
// prior_map_trials from 1001 on.
inline constexpr double kFieldOfViewFraction = 0.85;  ///< of the farthest: reliably detected
inline constexpr double kCoverageFraction = 0.7;      ///< the same, of a direction's usual range

// Detection on another visit; on two drives of config/orchard_hard.yaml with bushes.
inline constexpr double kObservationsWorth = 2.0;  ///< of one visit's rate for another visit

// Rigid submaps; on config/block.yaml, seeds 1001 and 1, and config/scale.yaml.
inline constexpr double kRigidMotionSd_m = 0.05;  ///< a less certain motion bends a submap
inline constexpr double kRigidMotionSd_rad = 0.02;
inline constexpr double kSubmapRigiditySd_m = 0.01;  ///< of a landmark in its submap

// Scan matching; on the koala and Riseholme recordings and scene yard, seeds 1-6.
inline constexpr double kFlatnessMax = 0.05;  ///< variance across to along of a smooth surface
inline constexpr double kSurfaceLengthSd_m = 0.06;  ///< min extent of a surface with a normal
inline constexpr double kKernel_m = 0.3;            ///< a pair at this distance weighs a quarter
inline constexpr double kKernelFine_m = 0.10;       ///< the same in the last iterations
inline constexpr double kScoreGood = 0.75;          ///< below it a better pose is searched for
inline constexpr double kScoreReliable = 0.35;      ///< below it a match is a guess
inline constexpr double kScoreAdvantage = 0.05;     ///< of a pose found over the predicted one
inline constexpr double kAlongFraction = 0.05;      ///< weight of a residual along a surface
inline constexpr double kCorrelatedPoints = 4.0;    ///< neighbouring points that count as one
inline constexpr double kFractionByChance = 0.045;  ///< informative on an endless surface

// A motion that nothing measured, about that of 2 m/s for half a second; on both Pullally drives.
inline constexpr double kUnknownShiftSd_m = 1.0;
inline constexpr double kUnknownTurnSd_rad = 0.6;

// Loop closure by scans; on scene yard, seeds 1-4.
inline constexpr double kScanClosureScoreMin = 0.5;  ///< per point in known cells
inline constexpr double kScanClosureKnownMin = 0.4;  ///< fraction of points in known cells
inline constexpr double kScanClosureLead = 0.2;      ///< of the best pose, of its score
inline constexpr double kScanClosureFitMin = 0.4;    ///< score of the fit of all points
inline constexpr double kScanRoughness_m = 0.15;     ///< repeatability: a bent path, leaves

// Loop closure by trunks, tracking; on config/block.yaml, seeds 1001 and 1, and slam_trials park
// 7, 15 and 17.
inline constexpr double kClosureSubmap_ranges = 2.5;    ///< path that is registered, sight ranges
inline constexpr double kPairTolerance_m = 0.35;        ///< of a pair's distance, recent and old
inline constexpr double kDistortion = 0.004;            ///< of the recent map, per metre
inline constexpr double kMissOdds = 2.0;                ///< log-odds of a tree on one side only
inline constexpr double kMatchedFraction = 0.7;         ///< min of the trees in view
inline constexpr double kSurelySeenFraction = 0.5;      ///< of the range at which it was seen
inline constexpr double kRivalScore = 4.0;              ///< log-likelihood of a scan's second pose
inline constexpr double kTrackedTravel_ranges = 0.3;    ///< travel for which one is tracked now
inline constexpr double kCovisibleTravel_ranges = 0.8;  ///< travel from one that is tracked
inline constexpr double kNewSessionSd_m = 0.25;         ///< a surer pose waits for a match

// Localisation in a prior map; on prior_map_trials from 1001 on and both Pullally drives.
inline constexpr double kLatticeDensity = 3.0;   ///< of trunks where any lattice expects one [1/m2]
inline constexpr double kLocalBendSd_m = 0.015;  ///< of the local map, per root metre
inline constexpr double kLocalBendSd_rad = 0.003;
inline constexpr double kUnseenFraction = 0.1;  ///< a trunk is mapped where no drive looked
/// Min sum of the best pose's score and its log-odds against the other poses. Other poses in the
/// map act as another orchard with the same planting pattern, because they must explain the same
/// trunks. In maps of other orchards this sum was at most 14 (137 drives, one above 8.3).
inline constexpr double kScoreAndLeadElsewhere = 20.0;
inline constexpr double kLostFraction = 0.5;       ///< fewer expected trees are seen: given up
inline constexpr double kDetectedFraction = 0.8;   ///< more are seen: only a rival ends a position
inline constexpr double kRivalGap = 6.0;           ///< of d2 to the second best landmark
inline constexpr double kSightingsPerTree = 10.0;  ///< count as one: they share the map's error
inline constexpr double kDistortedSd_m = 0.25;     ///< a less certain trunk is no evidence

// The ground before any way is driven; on config/hills.yaml, seeds 1001-1004, slope 25 %.
inline constexpr double kStartSlopeSd = 0.09;  ///< of the robot's tilt about the plane [m/m]

}  // namespace orchard::pose
