// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/compare/clump.hpp"
#include "mapping/compare/map_alignment.hpp"

namespace orchard::mapping {

enum class Change {
  kUnchanged,
  kMissing,  ///< stood in the earlier map; the later drive looked there and found nothing
  kNew,      ///< the other way round
  kMoved,    ///< stands elsewhere, against its neighbours
  kGrown,    ///< wider than before
  kThinner,  ///< thinner than before: another tree, perhaps
  kNotSeen,  ///< one drive did not look there well enough to tell
};
inline constexpr int kNumChanges = 7;

struct ComparisonConfig {
  double confidence_min = 0.8;  ///< of missing and new (what is less sure is not seen), of widths
  double moved_min_m = 0.15;    ///< smaller moves are none
  double moved_max_m = 1.6;     ///< farther away it is another tree
  double width_change_min_m = 0.01;
  double sigmas_min = 3.0;    ///< of moves and of width changes, in standard errors
  bool assume_seen = false;   ///< both drives looked everywhere
  bool with_objects = false;  ///< compare objects too, not only trees
  ThicketConfig thicket;
};

/// What became of one thing.
struct MapChange {
  Change change = Change::kUnchanged;
  double confidence = 0.0;         ///< that this is so, in [0, 1]
  std::int32_t a = -1;             ///< index into the earlier map; -1: not in it
  std::int32_t b = -1;             ///< index into the later map
  Eigen::Vector2d p_a{0, 0};       ///< in the frame of the earlier map; where it stands now
  double moved_m = 0.0;            ///< bends of the maps taken out
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

/// Tells what changed between an earlier map a and a later map b, which `alignment` lays upon it.
///
/// A class that changed is no change. Maps are straightened against each other first: what
/// neighbours share is the maps' bend. Standard errors of positions are taken from how the pairs of
/// the two maps scatter, those of widths from the pairs of trees (map.csv has none), more for what
/// was seen seldom. A tree that grew with all others has grown.
/// Missing and new are weighed by how likely the other drive would have missed the thing
/// (DriveView::probability_missed), moved, grown and replaced against each other and against noise
/// (odds_of()); one tree in twenty changes each way. Moved is what more likely moved than not.
MapComparison compare_maps(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                           const DriveView& view_a, const DriveView& view_b,
                           const MapAlignment& alignment, const ComparisonConfig& config);

/// missing, new ...: a change as files write it.
const char* change_text(Change change);

}  // namespace orchard::mapping
