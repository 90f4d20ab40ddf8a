// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/compare/map_alignment.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Parameters of clumps: landmarks so close together that they may be parts of one object.
struct ClumpConfig {
  double near_m = 0.5;     ///< two other landmarks within this distance make a clump
  double reach_m = 0.8;    ///< max distance between parts of one clump
  double stake_m = 0.045;  ///< thinner ones are stakes, which do not count
};

/// Whether each landmark is part of a clump: at least two others nearby, not counting stakes and
/// stalks. Each drive observes different parts of a bush, so such landmarks are not reproducible.
std::vector<char> in_clumps(const std::vector<Landmark>& landmarks, const ClumpConfig& config);

enum class Change {
  kUnchanged,
  kMissing,  ///< only in the earlier map, although the later drive would have detected it
  kNew,      ///< only in the later map, although the earlier drive would have detected it
  kMoved,    ///< position changed relative to the neighbours
  kGrown,    ///< wider than before
  kThinner,  ///< thinner than before, perhaps another tree
  kNotSeen,  ///< outside, or nearly outside, the field of view of one drive
};
inline constexpr int kNumChanges = 7;  // derived: of the list above

/// Configuration of compare_maps().
struct ComparisonConfig {
  double confidence_min = 0.8;  ///< of missing and new (else not seen) and of width changes
  double moved_min_m = 0.15;    ///< min displacement of a move
  double moved_max_m = 1.6;     ///< max displacement; farther away it is another tree
  double sigmas_min = 3.0;      ///< of displacements and width changes, in standard errors
  bool assume_seen = false;     ///< assume that both drives observed every position
  bool with_objects = false;    ///< compare objects too, not only trees
  ClumpConfig clump;
};

/// Change of one object.
struct MapChange {
  Change change = Change::kUnchanged;
  double confidence = 0.0;         ///< probability of the change, in [0, 1]
  std::int32_t a = -1;             ///< index into the earlier map; -1: not in it
  std::int32_t b = -1;             ///< index into the later map; -1: not in it
  Eigen::Vector2d p_a{0, 0};       ///< current position, in the frame of the earlier map
  double moved_m = 0.0;            ///< after non-rigid residual removal
  double width_change_m = 0.0;     ///< b minus a
  double width_change_se_m = 0.0;  ///< standard error of width_change_m
};

struct MapComparison {
  std::vector<MapChange> changes;      ///< in order of a, then those only in b, in order of b
  double width_change_common_m = 0.0;  ///< median of pairs of trees: growth or scanner
  double width_change_common_se_m = 0.0;

  int count(Change change) const;
};

/// Classifies the changes between an earlier map a and a later map b, registered by `alignment`.
///
/// A change of class is not reported. Non-rigid residuals, which neighbours share, are removed
/// first. Standard errors of positions come from the scatter of all pairs, those of widths from the
/// pairs of trees (map.csv has none); both are larger for few observations. A tree that grew like
/// all others is reported as grown. Missing and new are posteriors from the detection probability
/// of the other drive (DetectionMap::probability_missed). Unchanged, moved, grown and replaced are
/// posteriors of change_posterior() with prior 1/20 for each change. Moved is reported if its
/// posterior exceeds 1/2.
MapComparison compare_maps(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                           const DetectionMap& view_a, const DetectionMap& view_b,
                           const MapAlignment& alignment, const ComparisonConfig& config);

/// Text of a change in files: missing, new, ...
const char* change_text(Change change);

}  // namespace orchard::mapping
