// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/compare/clump.hpp"
#include "mapping/compare/map_alignment.hpp"

namespace orchard::mapping {

enum class Change {
  kUnchanged,
  kMissing,  ///< in the earlier map; the later drive would have detected it
  kNew,      ///< the other way round
  kMoved,    ///< stands elsewhere, against its neighbours
  kGrown,    ///< wider than before
  kThinner,  ///< thinner than before: another tree, perhaps
  kNotSeen,  ///< outside the field of view of one drive, or nearly
};
inline constexpr int kNumChanges = 7;

struct ComparisonConfig {
  double confidence_min = 0.8;  ///< of missing and new (what is less sure is not seen), of widths
  double moved_min_m = 0.15;    ///< smaller moves are none
  double moved_max_m = 1.6;     ///< farther away it is another tree
  double width_change_min_m = 0.01;
  double sigmas_min = 3.0;    ///< of moves and of width changes, in standard errors
  bool assume_seen = false;   ///< everything was in view of both drives
  bool with_objects = false;  ///< compare objects too, not only trees
  ClumpConfig clump;
};

/// Change of one object.
struct MapChange {
  Change change = Change::kUnchanged;
  double confidence = 0.0;         ///< that this is so, in [0, 1]
  std::int32_t a = -1;             ///< index into the earlier map; -1: not in it
  std::int32_t b = -1;             ///< index into the later map
  Eigen::Vector2d p_a{0, 0};       ///< in the frame of the earlier map; where it stands now
  double moved_m = 0.0;            ///< after non-rigid residual removal
  double width_change_m = 0.0;     ///< b minus a
  double width_change_se_m = 0.0;  ///< standard error of that
};

struct MapComparison {
  std::vector<MapChange> changes;  ///< in order of a, then what is only in b in order of b
  double width_change_common_m =
      0.0;  ///< median over the pairs of trees: growth, or another scanner
  double width_change_common_se_m = 0.0;

  int count(Change change) const;
};

/// Classifies the changes between an earlier map a and a later map b, registered by `alignment`.
///
/// A class that changed is no change. Non-rigid residuals, those that neighbours share, are removed
/// first. Standard errors of positions are taken from the scatter of all pairs, those of widths
/// from the pairs of trees (map.csv has none), larger for few observations. A tree that grew with
/// all others has grown. Missing and new are posteriors by the detection probability of the other
/// drive (DetectionMap::probability_missed); unchanged, moved, grown and replaced are weighed
/// against each other (change_posterior()), with a prior of one tree in twenty for each change.
/// Moved is reported where it is more likely than not.
MapComparison compare_maps(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                           const DetectionMap& view_a, const DetectionMap& view_b,
                           const MapAlignment& alignment, const ComparisonConfig& config);

/// missing, new ...: a change as files write it.
const char* change_text(Change change);

}  // namespace orchard::mapping
