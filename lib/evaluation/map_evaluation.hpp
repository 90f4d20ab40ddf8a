// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "evaluation/map_alignment.hpp"
#include "evaluation/trajectory_evaluation.hpp"
#include "mapping/landmark.hpp"
#include "simulation/scene/world.hpp"

namespace orchard::evaluation {

/// One true object and its landmark, if any.
struct EvaluatedObject {
  simulation::TruthObject truth;  ///< name: T1, T2 ... and B1, B2 ... in the truth's order
  std::optional<mapping::Landmark> landmark;
  double error_x_m = 0.0;  ///< landmark minus truth; 0 when missed
  double error_y_m = 0.0;
  double error_m = 0.0;  ///< norm of the error

  /// Whether map and truth know the height of the ground there.
  bool has_heights() const {
    return landmark && landmark->z_sd_m > 0.0 && std::isfinite(truth.z_m);
  }
  double height_error_m() const { return landmark->z_m - truth.z_m; }

  /// True if found with the right class.
  bool right_class() const { return landmark && landmark->label == truth.label; }
};

/// Results for the map before alignment, when the aligned map is evaluated.
struct Unaligned {
  geometry::Pose2 T_truth_map;  ///< the alignment
  int num_trees_found = 0;      ///< trees within the gate without alignment
  ErrorStatistics trees;        ///< errors of those trees [m]
};

/// Evaluation of a map against the truth.
struct MapEvaluation {
  double gate_m = 0.0;
  std::vector<EvaluatedObject> objects;  ///< in the truth's order
  std::vector<mapping::Landmark> extra;  ///< landmarks without a true object, in order of id
  /// confusion[truth][map], both indexed by detection::Label (kUnseen 0, kTree 1, kObject 2); only
  /// matched objects, so row kUnseen is empty.
  std::array<std::array<int, 3>, 3> confusion{};
  int num_trees = 0;  ///< true trees
  int num_objects = 0;
  int num_missed = 0;
  int num_wrong_class = 0;
  int num_trees_missed = 0;  ///< trees without a landmark of any class
  /// Extra landmarks of class tree within the gate of a tree that is matched with another landmark.
  int num_duplicates = 0;
  std::optional<Unaligned> unaligned;
  ErrorStatistics all;  ///< position errors of all matched objects [m]
  ErrorStatistics trees;
  /// Errors of the matched objects' heights [m], where map and truth know them; of an aligned map
  /// without their mean.
  ErrorStatistics heights;
  double height_nees = 0.0;     ///< mean of (height error / z_sd_m)^2: 1 if the claim is true
  double roc_mean_trees = 0.0;  ///< mean of the matched trees' roc_mean
  double se_x_mean_m = 0.0;     ///< mean standard errors of the matched trees
  double se_y_mean_m = 0.0;

  /// True if every object is found once with its class and there are no extra landmarks.
  bool perfect() const { return num_missed == 0 && num_wrong_class == 0 && extra.empty(); }
};

/// Compares landmarks with the truth, both in the map frame.
///
/// Matching uses positions only (see assign()): a tree that was mapped as an object is found, with
/// the wrong class. Throws std::invalid_argument for a gate that is not positive, for positions
/// that are not finite, and for a truth of class unseen.
MapEvaluation evaluate_map(const std::vector<mapping::Landmark>& landmarks,
                           const std::vector<simulation::TruthObject>& truth, double gate_m);

/// The same after aligning the map with the truth by its trees (see align_points()); with fewer
/// than three trees on one side, by all objects. A map without an alignment stays as it is.
MapEvaluation evaluate_aligned_map(const std::vector<mapping::Landmark>& landmarks,
                                   const std::vector<simulation::TruthObject>& truth, double gate_m,
                                   const AlignmentSearch& search = {},
                                   const std::optional<geometry::Pose2>& guess = {});

/// Tables 1 (trees) and 2 (non-tree objects) of Shalal et al. 2013 as text, with an additional
/// column for the error against truth. The last line of each table has means and RMS. Lengths in
/// mm. Lines end with a newline.
std::string paper_tables(const MapEvaluation& evaluation);

/// Summary for the user in a few lines: objects found, missed, confused and extra, and their
/// errors.
std::string evaluation_summary(const MapEvaluation& evaluation);

/// The whole evaluation as one JSON object. Lengths in m.
std::string evaluation_json(const MapEvaluation& evaluation);

/// Number of errors, their mean, root mean square and max [m], as an object of any JSON type.
template <class Json>
Json errors_json(const ErrorStatistics& summary) {
  return {{"n", summary.num},
          {"mean_m", summary.mean},
          {"rms_m", summary.rmse},
          {"max_m", summary.max}};
}

}  // namespace orchard::evaluation
