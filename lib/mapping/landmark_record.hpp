// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "detection/detection.hpp"
#include "geometry/point_grid.hpp"
#include "mapping/free_space.hpp"
#include "mapping/mapper_config.hpp"

namespace orchard::mapping {

/// State of one landmark: 112 bytes, independent of the number of observations.
///
/// At a million landmarks a landmark takes 176 bytes in total; the remainder is the grid entry and
/// the spare quarter of the growing table. Sums whose differences are used are doubles, all others
/// floats.
struct LandmarkRecord {
  double association_x_m = 0.0;  ///< mean of the aligned observations, used for association
  double association_y_m = 0.0;
  double mean_x_m = 0.0;  ///< unweighted mean of the composed observations
  double mean_y_m = 0.0;
  double roc_sum = 0.0;
  float m2_xx = 0.0f;  ///< sums of squares about the mean [m2]
  float m2_xy = 0.0f;
  float m2_yy = 0.0f;
  float association_information = 0.0f;  ///< 1 / m2
  float scatter_m2 = 0.0f;               ///< of the aligned observations, per axis
  float width_m = 0.0f;
  float width_information = 0.0f;   ///< 1 / m2
  float width_chi2 = 0.0f;          ///< of the widths about their mean, by their variances
  float width_observations = 0.0f;  ///< effective number of independent widths
  float width_x_base_m = 0.0f;      ///< position of the last width observation in base
  float width_y_base_m = 0.0f;
  float log_odds = 0.0f;               ///< of being a tree: sum of the evidence of its observations
  std::int32_t num_observations = 0;   ///< N of eq. 13
  std::int32_t num_all = 0;            ///< including UNSEEN ones
  std::int32_t last_observation = -1;  ///< head of its chain in the ObservationStore
  std::int32_t last_scan = -1;
  float existence_log_odds = 0.0f;  ///< log odds that it still exists: ExistenceFilter
  bool is_seen = false;             ///< judged by the camera, or by a laser-only rig
  bool is_removed = false;
  Clearance clearance = Clearance::kUntold;  ///< the best of its observations
  bool is_clump = false;                     ///< merged from touching parts, none of them a tree

  Eigen::Vector2d association_position() const { return {association_x_m, association_y_m}; }
};
static_assert(sizeof(LandmarkRecord) == 112, "an orchard has a million of them");

/// derived: Limit of the log odds of a class, so that later observations can still change it.
inline constexpr double kLogOddsMax = 30.0;

/// Limit of the sum of log odds: kLogOddsMax for labels; effectively none for probabilities, which
/// are tempered in log_odds_of_tree().
double log_odds_max(const MapperConfig& config);

/// Updates the association position with an aligned observation, weighted by inverse variance, and
/// the scatter with its distance.
void fuse_association_position(LandmarkRecord& record, const Eigen::Vector2d& p_aligned,
                               double variance_m2);

/// Adds an observation's width to the mean width, weighted by its variance.
///
/// The width error of a detection depends on how its beams fall, so an observation taken less than
/// one beam step (in base) from the last one counts by that fraction. Partly occluded observations
/// get almost no weight. The same holds at ranges where an object of the mean width may be hit by
/// `min_beams` beams or fewer: narrow observations are missing there, so the others are biased.
void fuse_width(LandmarkRecord& record, const detection::Detection& d, int min_beams);

/// Standard error of the mean width [m], from the observation variances, or from their scatter if
/// that is larger (trunks are not round). 0 for a record without a width.
double width_sd_m(const LandmarkRecord& record);

/// Adds one composed observation to the paper's statistics (Welford) and to the log odds.
///
/// UNSEEN observations count only until the first labelled one; from then on only labelled ones
/// count, as in the paper's tables. `evidence`: log likelihood ratio of the observation.
void accumulate(LandmarkRecord& record, const Eigen::Vector2d& p_map, double roc_tree,
                detection::Label label, double evidence, double log_odds_max = kLogOddsMax);

/// Adds the statistics of `from` to `into` (sums of two samples: Chan et al. 1979). The caller
/// joins the chains of observations.
void merge(LandmarkRecord& into, const LandmarkRecord& from, double log_odds_max = kLogOddsMax);

/// Standard error of the mean in x and y [m], with N - 1: Shalal et al. 2013, eq. 13. 0 for N = 1.
Eigen::Vector2d standard_error_m(const LandmarkRecord& record);

/// Fractions of a tree's and of an object's observations that are labelled TREE.
struct TreeRates {
  double of_trees = 0.0;
  double of_objects = 0.0;
};
TreeRates tree_rates(const MapperConfig& config);

/// Log likelihood ratio (tree against object) of one observation, from its label or its calibrated
/// probability; 0 without either.
double evidence_of(const detection::Detection& observation, const MapperConfig& config);

/// Log odds of being a tree after `num_observations` observations with evidence sum `sum`. Evidence
/// labels: the sum. Evidence probability: the prior plus the tempered sum, within +-30; the
/// observations of one landmark are correlated, so n of them count as n / (1 + (n - 1)
/// evidence_correlation).
double log_odds_of_tree(double sum, int num_observations, const MapperConfig& config);

/// Probability that the landmark is a tree: prior 1/2 for labels, as configured for probabilities.
/// By width alone it is that of one label: whether the width of a thing fits a trunk is the same
/// whenever it is measured, so all observations say what one says.
double probability_of_tree(const LandmarkRecord& record, const MapperConfig& config);

/// Tree or object by the sign of the log odds; unseen while no observation is labelled.
detection::Label label_of(const LandmarkRecord& record, const MapperConfig& config);

/// All landmarks by index (id - 1), with a spatial grid over their association positions. Every
/// change updates both. Indices are never reused, even after a landmark was merged away.
class LandmarkTable {
 public:
  LandmarkTable() = default;

  /// Builds a table in which records[i] has index i; removed records are empty slots.
  explicit LandmarkTable(std::vector<LandmarkRecord> records);

  /// Adds a landmark with the given association position and no observations; returns its index.
  /// Throws std::length_error when no indices are left.
  std::int32_t add(const Eigen::Vector2d& p_map, double width_m);

  const LandmarkRecord& operator[](std::int32_t index) const {
    return records_[static_cast<std::size_t>(index)];
  }

  /// Calls change(record) and updates the grid with the new association position.
  template <class Change>
  void change(std::int32_t index, Change&& change) {
    LandmarkRecord& r = records_[static_cast<std::size_t>(index)];
    const Eigen::Vector2d from = r.association_position();
    change(r);
    grid_.move(index, from.x(), from.y(), r.association_x_m, r.association_y_m);
  }

  /// Replaces the record by an empty one with is_removed set.
  void remove(std::int32_t index);

  /// Calls visit(index, record) for a superset of the landmarks within `radius_m` of a point.
  template <class Visit>
  void near(const Eigen::Vector2d& p_map, double radius_m, Visit&& visit) const {
    grid_.near(p_map.x(), p_map.y(), radius_m,
               [&](std::int32_t i) { visit(i, records_[static_cast<std::size_t>(i)]); });
  }

  /// Largest index ever used plus one.
  std::int32_t num_indices() const { return static_cast<std::int32_t>(records_.size()); }
  std::size_t num_alive() const { return num_alive_; }
  std::size_t num_bytes() const;

 private:
  std::vector<LandmarkRecord> records_;
  geometry::PointGrid grid_;
  std::size_t num_alive_ = 0;
};

}  // namespace orchard::mapping
