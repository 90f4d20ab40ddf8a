// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "detection/detection.hpp"
#include "mapping/mapper_config.hpp"

namespace orchard::mapping {

/// What is kept per landmark: 112 bytes, whatever the number of its observations.
///
/// The rest of a landmark's 176 bytes at a million of them is the grid's entry, and the quarter by
/// which the table grows. Sums that a difference is taken of are doubles, all others floats.
struct LandmarkRecord {
  double association_x_m = 0.0;  ///< mean of the aligned observations, which association uses
  double association_y_m = 0.0;
  double mean_x_m = 0.0;  ///< plain mean of the composed observations
  double mean_y_m = 0.0;
  double roc_sum = 0.0;
  float m2_xx = 0.0f;  ///< sums of squares about the mean [m2]
  float m2_xy = 0.0f;
  float m2_yy = 0.0f;
  float association_information = 0.0f;  ///< 1 / m2
  float scatter_m2 = 0.0f;               ///< of the aligned observations about it, per axis
  float width_m = 0.0f;
  float width_information = 0.0f;   ///< 1 / m2
  float width_chi2 = 0.0f;          ///< of the widths about their mean, by their own variances
  float width_observations = 0.0f;  ///< how many widths that differ that mean is of
  float width_x_base_m = 0.0f;      ///< where in base the last of them was seen
  float width_y_base_m = 0.0f;
  float log_odds = 0.0f;               ///< of being a tree: sum of the evidence of its observations
  std::int32_t num_observations = 0;   ///< N of eq. 13
  std::int32_t num_all = 0;            ///< UNSEEN ones too
  std::int32_t last_observation = -1;  ///< head of its chain in the ObservationStore
  std::int32_t last_scan = -1;
  float existence_log_odds = 0.0f;  ///< that it still stands there: ExistenceFilter
  bool is_seen = false;             ///< by the camera, or laser-only rig
  bool is_removed = false;
  bool is_clump = false;  ///< parts that touch, none of them a tree: extent_radius_m()

  Eigen::Vector2d association_position() const { return {association_x_m, association_y_m}; }
};
static_assert(sizeof(LandmarkRecord) == 112, "an orchard has a million of them");

/// However many labels agree, a landmark can still be talked out of its class.
inline constexpr double kLogOddsMax = 30.0;

/// Most that the sum of log odds may grow to: kLogOddsMax of labels; probabilities are tempered
/// when they are read, so their sum is not cut.
double log_odds_max(const MapperConfig& config);

/// Moves the association position towards an aligned observation by its part of the information,
/// and adds the distance to the scatter.
void fuse_association_position(LandmarkRecord& record, const Eigen::Vector2d& p_aligned,
                               double variance_m2);

/// Adds an observation's width to the mean width, weighted by its variance.
///
/// A width is a count of beams, so it errs anew only when the beams fall anew: from a place in base
/// less than one beam away from the last, an observation counts by that fraction. And where a thing
/// as wide as the mean is not always met by more than `fewest_beams`, the observations that make it
/// too narrow may be missing: the others, and those of which a side is hidden, count for next to
/// nothing.
void fuse_width(LandmarkRecord& record, const detection::Detection& d, int fewest_beams);

/// Standard error of the mean width [m]: by the observations' own variances, or by how they scatter
/// where that is more (trunks are not round). 0 for a record without a width.
double width_sd_m(const LandmarkRecord& record);

/// Adds one composed observation to the paper's statistics (Welford) and to the log odds.
///
/// Observations that the camera did not see count until the first that it saw; from then on only
/// those it sees do, as in the paper's tables. `evidence` is the observation's log likelihood
/// ratio.
void accumulate(LandmarkRecord& record, const Eigen::Vector2d& p_map, double roc_tree,
                detection::Label label, double evidence, double log_odds_max = kLogOddsMax);

/// Makes `into` what it would be had it made the observations of `from` too: sums of two samples
/// (Chan et al. 1979). The chains of observations are the caller's.
void merge(LandmarkRecord& into, const LandmarkRecord& from, double log_odds_max = kLogOddsMax);

/// Standard error of the mean in x and y [m], with N - 1: Shalal et al. 2013, eq. 13. 0 for N = 1.
Eigen::Vector2d standard_error_m(const LandmarkRecord& record);

/// Fractions of the observations of a tree, and at anything else, that are labelled TREE.
struct TreeRates {
  double of_trees = 0.0;
  double of_objects = 0.0;
};
TreeRates tree_rates(const MapperConfig& config);

/// Log likelihood ratio of one observation: how much likelier a tree gives it than anything else
/// does. By its label, or by its calibrated probability; 0 for one that nothing judged.
double evidence_of(const detection::Detection& observation, const MapperConfig& config);

/// Log odds of being a tree from `num_observations` observations whose evidence sums to `sum`.
/// Evidence labels: the sum. Evidence probability: the prior, and the sum tempered, as observations
/// of one thing repeat each other: n of them count as n / (1 + (n - 1) evidence_correlation).
/// Within 30.
double log_odds_of_tree(double sum, int num_observations, const MapperConfig& config);

/// That the landmark is a tree: of labels with prior 1/2, of probabilities as configured.
double probability_of_tree(const LandmarkRecord& record, const MapperConfig& config);

/// Tree or object by the log odds; unseen while no camera saw it.
detection::Label label_of(const LandmarkRecord& record, const MapperConfig& config);

}  // namespace orchard::mapping
