// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

/// The mapper's tuned constants: chosen by trying. Those of this room that are not here are
/// physical or derived, and say from what.
namespace orchard::mapping::tuning {

// On both drives at Pullally (config/pullally.yaml) and the simulated orchards
// (config/orchard.yaml, orchard_hard.yaml).

/// Observations from which a landmark's position is reliable enough for the relaxed gate.
inline constexpr int kWellKnownObservations = 30;
inline constexpr double kWidthRelativeSd = 0.15;  ///< of one object observed from different sides
/// Fraction of the observations of a tree, and of any other object, with the wrong label.
inline constexpr double kWrongLabels = 0.2;
/// Fractions of observations with a reflector flash: every second view of a tape is turned away or
/// dirty, and hardly any other object is as bright.
inline constexpr double kFlashRateOfTrees = 0.5;
inline constexpr double kFlashRateOfObjects = 0.02;
/// Weight of a width observation that is known to be biased.
inline constexpr double kHint = 0.01;
/// Log odds of being a tree below which a landmark is certainly not one.
inline constexpr double kSurelyNone = -2.0;
/// Max gap between touching borders [m]: scanners do not see through it, and nobody passes.
inline constexpr double kTouch_m = 0.15;
/// Quantile of the scatter of the trees of rows: one in twenty may have suckers or lean.
inline constexpr double kOfTrees = 0.95;

// Existence, on simulated drives among people and vehicles and both drives at Pullally.

/// Probability that beams pass through the position of an existing object: thin objects and wrong
/// poses.
inline constexpr double kPassRate = 0.1;
/// Probability that they pass if the object is gone; less than 1 because another may be in front.
inline constexpr double kPassRateGone = 0.7;
/// Number of beams across an object from which their evidence has full weight.
inline constexpr int kFullBeams = 6;
/// Upper limit of the existence log odds, so that a landmark can still be dropped later.
inline constexpr double kBeamLogOddsMax = 8.0;
/// Log odds of existence below which a landmark is dropped (12 %).
inline constexpr double kLogOddsGone = -2.0;
/// Landmarks with this many observations are not strays.
inline constexpr int kStrayObservationsMax = 30;
/// A bush hides its stem from all but about one of four sides.
inline constexpr double kStemFraction = 0.25;
/// Number of votes that decide.
inline constexpr int kVotes = 8;
inline constexpr int kReturnWeight = 3;
/// Minimum fraction of a place that must be seen free where an object is denied: of the beams
/// across its position uncertainty, or of the ground on which it would stand.
inline constexpr double kPassFraction = 0.8;

// Rows, on random planted blocks (tests/unit/mapping/rows/planted_rows.hpp) and both drives at
// Pullally.

/// Trees closer than this are in the same slot.
inline constexpr double kOnePlace_spacings = 0.3;
inline constexpr double kReach_spacings = 4.5;
/// Distance within which links determine the direction and the spacing at a point, in spacings.
inline constexpr double kLinkReach_spacings = 4.5;
/// Objects within this distance tell how densely they stand, in spacings: no neighbour in the row.
inline constexpr double kAround_spacings = 0.75;
/// Maximum turn of a row between two trees (cosine of 30 degrees).
inline constexpr double kTurnMax_cos = 0.866;
/// Max lateral offset of the next tree of a row, in distances of rows; and the weight of that
/// offset in the cost of a link: the next tree should be straight ahead.
inline constexpr double kBesideMax_row_spacings = 0.35;
inline constexpr double kCostBeside = 3.0;
/// Chains at a larger angle to the rows (cosine of 60 degrees) are hedges or headlands.
inline constexpr double kAcross_cos = 0.5;
/// Minimum distance of a row from a more certain one, as a fraction of the rows' distance.
inline constexpr double kNearest_pitches = 0.6;
/// Steps on either side that determine the local spacing.
inline constexpr std::size_t kSpacingWindow = 15;
/// Trees at the start of a row that are compared with the neighbouring row.
inline constexpr std::size_t kNumCompared = 4;
/// Probability that a row goes on to something else beyond its last tree, and fraction of trees
/// among what stands outside of rows: at Pullally by its laser alone, where bushes end the rows
/// (tests/experiments/pullally_things.csv).
inline constexpr double kGoesOn = 0.4, kTreesOutsideRows = 0.05;
/// Rows on either side that determine where a row should start.
inline constexpr int kRowsAround = 8;
/// Start of a row against those around it, in minus log likelihoods: of an empty slot, of a row
/// that does not follow, and of a headland that is not perpendicular; and the scatter in slots.
inline constexpr double kCostMissing = 2.3, kCostMax = 7.0, kCostSlope = 6.0, kScatter = 0.2;

// Comparison of maps, on pairs of simulated days and both drives at Pullally.

inline constexpr double kGrowthScale_m = 0.05;            ///< of widths that changed (exponential)
inline constexpr double kOutlierScale_m = 0.1;            ///< of outliers among widths
inline constexpr double kOutlierPosition_m = 0.1;         ///< of outliers among positions, per axis
inline constexpr double kPositionOutliersOfTrees = 0.01;  ///< fraction of unchanged pairs
inline constexpr double kPositionOutliersOfOthers = 0.05;
inline constexpr double kOutliersMax = 0.3;
inline constexpr double kBushPosition_m = 0.03;  ///< additional position sd of width outliers
/// Fraction of the tree spacing beyond which it is another tree.
inline constexpr double kNearestOther = 0.9;
/// Quantile of the visibilities of a well visible tree.
inline constexpr double kSeenWell = 0.75;

// Photographs, on koala's poles and the simulated orchard.

/// Factor on the worth of a partly hidden subject: less than a poorer image of the whole.
inline constexpr double kHiddenWorth = 0.2;
/// Minimum ratio of worth for replacing a view.
inline constexpr double kBetter = 1.05;

// For laying two maps upon each other; on which data they were chosen is not recorded.

/// Minimum fraction of inliers among the points around an anchor.
inline constexpr double kInlierFraction = 0.4;
/// Half width of a row, relative to the distance of the nearest tree; excludes the rows beside it.
inline constexpr double kRowHalf = 1.5;
/// Pairs by which the noise of a hypothesis is drawn towards that of the null hypothesis.
inline constexpr double kNullPairs = 5.0;
/// Fraction of true pairs outside the noise model.
inline constexpr double kOutlierFraction = 0.05;
/// Hypotheses with fewer pairs than this fraction of the most are no rivals.
inline constexpr double kRivalPairsFraction = 0.2;
/// Neighbours that share a deformation.
inline constexpr double kBendNeighbours = 10.0;

}  // namespace orchard::mapping::tuning
