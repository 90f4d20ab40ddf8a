// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

/// The laser's tuned constants: chosen by trying. Those of this room that are not here are physical
/// or derived, and say from what.
namespace orchard::laser::tuning {

// On scans of the simulated orchard, seeds 1001 and up (config/orchard.yaml, orchard_hard.yaml).

/// Fraction of the separating step that noise alone may cause at the border of an object.
inline constexpr double kBorderNoiseFraction = 0.35;
/// Cosine of incidence below which a beam has no weight (it grazes; the sides constrain it better)
/// and above which it has full weight. The ramp keeps the weights continuous during convergence.
inline constexpr double kGrazingCosine = 0.2;
inline constexpr double kSteepCosine = 0.4;
/// Residuals beyond this many sigmas are down-weighted (Huber).
inline constexpr double kHuber = 2.5;
/// Chi2 per degree of freedom below which a fit is explained by noise, and largest one of a circle
/// that is reported: trunks are not round, and bark is rough.
inline constexpr double kGoodFit = 3.0;
inline constexpr double kWorstFit = 4.0;
/// From step kStepsToJudge on a fit is abandoned if its chi2 per degree of freedom exceeds
/// kHopeless[step] times kGoodFit: such fits seldom converge to a good circle.
inline constexpr int kStepsToJudge = 2;
inline constexpr std::array<double, 5> kHopeless{5.0, 4.0, 3.0, 2.0, 1.4};
/// A fit whose steps are still this long after this many steps oscillates.
inline constexpr int kStepsToSettleDown = 7;
inline constexpr double kRestless_m = 1e-3;

// On pairs of discs with a field scanner's noise, 400 seeds (StemPairs in tests/unit/laser), and on
// the vines of Riseholme.

/// Prior probability that what stands somewhere is two touching stems: of a plantation's trees a
/// few in a hundred have a second one.
inline constexpr double kPairs = 0.02;
/// Difference in distance, in radii, from which one part is behind the other, not beside it.
inline constexpr double kBehind = 0.75;
/// Penalty of a part of one or two clutter beams, in chi2.
inline constexpr std::array<double, 2> kThinCosts{15.0, 18.0};
/// Largest fraction of the beams that may be clutter.
inline constexpr double kMaxClutterFraction = 0.25;
/// Smallest fraction of the beams in a circle: fewer are mixed pixels at a trunk's border.
inline constexpr double kMinFraction = 1.0 / 6.0;
/// Number of consecutive part lengths without a good circle after which longer ones are not tried.
/// The first lengths may all lie on a trunk's border, so more of them are allowed.
inline constexpr int kMaxMisfits = 3;
inline constexpr int kMaxMisfitsAtFirst = 8;
/// Min prominence of a range maximum between two bulges, in sigmas, for a split to be tried.
inline constexpr double kProminence = 2.0;
/// Prominence in sigmas above which a split is accepted even if no single circle fits to compare.
inline constexpr double kClearProminence = 8.0;

// On drives at Pullally and of the simulated robot with a mast.

/// Max fraction of the field of view that the robot itself covers.
inline constexpr double kOwnViewMax = 0.2;
/// Max fraction of scans in which a direction of the environment has a return within the clearance.
inline constexpr double kRarely = 0.05;
/// Min fraction of scans with a return from an object that travels along.
inline constexpr double kOften = 0.5;

}  // namespace orchard::laser::tuning
