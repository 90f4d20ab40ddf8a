// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "detection/detection.hpp"

namespace orchard::mapping {

/// What is kept per landmark: 96 bytes, whatever the number of its observations.
///
/// The rest of a landmark's 156 bytes at a million of them is the grid's entry, and the quarter by
/// which the table grows. Sums that a difference is taken of are doubles, all others floats.
struct LandmarkRecord {
  double anchor_x_m = 0.0;  ///< mean of the aligned observations: what association compares with
  double anchor_y_m = 0.0;
  double mean_x_m = 0.0;  ///< plain mean of the composed observations
  double mean_y_m = 0.0;
  double roc_sum = 0.0;
  float m2_xx = 0.0f;  ///< sums of squares about the mean [m2]
  float m2_xy = 0.0f;
  float m2_yy = 0.0f;
  float anchor_information = 0.0f;  ///< 1 / m2
  float scatter_m2 = 0.0f;          ///< of the aligned observations about the anchor, per axis
  float width_m = 0.0f;
  float width_information = 0.0f;      ///< 1 / m2
  float log_odds = 0.0f;               ///< of being a tree
  std::int32_t num_observations = 0;   ///< N of eq. 13
  std::int32_t num_all = 0;            ///< UNSEEN ones too
  std::int32_t last_observation = -1;  ///< head of its chain in the ObservationStore
  std::int32_t last_scan = -1;
  bool is_seen = false;  ///< by the camera, or laser-only rig
  bool is_removed = false;

  Eigen::Vector2d anchor() const { return {anchor_x_m, anchor_y_m}; }
};
static_assert(sizeof(LandmarkRecord) == 96, "an orchard has a million of them");

/// Moves the anchor towards an aligned observation by its share of the information, and takes the
/// distance into the scatter.
void fuse_anchor(LandmarkRecord& record, const Eigen::Vector2d& p_aligned, double variance_m2);

/// Takes one measured width into the mean width, weighted by its variance.
void fuse_width(LandmarkRecord& record, double width_m, double width_sd_m);

/// Takes one composed observation into the paper's statistics (Welford) and into the log odds.
///
/// Observations that the camera did not see count until the first that it saw; from then on only
/// those it sees do, as in the paper's tables. `evidence` is the label's log likelihood ratio.
void accumulate(LandmarkRecord& record, const Eigen::Vector2d& p_map, double roc_tree,
                detection::Label label, double evidence);

/// Makes `into` what it would be had it made the observations of `from` too: sums of two samples
/// (Chan et al. 1979). The chains of observations are the caller's.
void merge(LandmarkRecord& into, const LandmarkRecord& from);

/// Standard error of the mean in x and y [m], with N - 1: Shalal et al. 2013, eq. 13. 0 for N = 1.
Eigen::Vector2d standard_error_m(const LandmarkRecord& record);

/// That the landmark is a tree, from the labels alone, prior 1/2.
double probability_of_tree(const LandmarkRecord& record);

/// Tree or object by the log odds; unseen while no camera saw it.
detection::Label label_of(const LandmarkRecord& record);

}  // namespace orchard::mapping
