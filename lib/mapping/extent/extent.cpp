// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/extent/extent.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/landmark_record.hpp"

namespace orchard::mapping {
namespace {

/// Log odds of being a tree below which a landmark is certainly not one.
constexpr double kSurelyNone = -2.0;

bool is_surely_no_tree(const LandmarkRecord& r, const MapperConfig& config) {
  return label_of(r, config) == detection::Label::kObject &&
         log_odds_of_tree(r.log_odds, r.num_observations, config) < kSurelyNone;
}

/// Whether a landmark is part of a clump whose extent it overlaps: two objects cannot stand in one
/// place. What is certainly no tree already is where the borders touch; here it is enough that it
/// is rather none, as for a detection.
bool overlaps(const LandmarkRecord& r, const LandmarkRecord& clump, double distance_m,
              const MapperConfig& config) {
  return clump.is_clump && is_surely_no_tree(clump, config) &&
         distance_m < extent_radius_m(clump) + extent_radius_m(r) &&
         label_of(r, config) != detection::Label::kTree && probability_of_tree(r, config) < 0.5;
}

}  // namespace

bool looks_like_a_tree(const detection::Detection& d) {
  return d.label == detection::Label::kTree || d.probability_tree > d.probability_object;
}

double extent_radius_m(const LandmarkRecord& r) {
  const double half_m = 0.5 * r.width_m;
  if (!r.is_clump) return half_m;
  // A uniform disc of radius R has a variance of R^2 / 4 per axis.
  return std::max(half_m, 2.0 * std::sqrt(std::max(0.0f, r.scatter_m2)));
}

std::int32_t touching_clump(const LandmarkTable& landmarks, std::int32_t index,
                            const MapperConfig& config) {
  const LandmarkRecord& r = landmarks[index];
  if (label_of(r, config) == detection::Label::kTree) return -1;
  const bool is_none = is_surely_no_tree(r, config);
  const double radius_m = extent_radius_m(r);
  std::int32_t best = -1;
  double best_gap_m = kTouch_m;
  landmarks.near(
      r.association_position(), radius_m + kTouch_m + 0.5 * config.object_width_max_m,
      [&](std::int32_t i, const LandmarkRecord& other) {
        if (i == index) return;
        const double other_m = extent_radius_m(other);
        const double distance_m = (other.association_position() - r.association_position()).norm();
        if (!(is_none && is_surely_no_tree(other, config)) &&
            !overlaps(r, other, distance_m, config) && !overlaps(other, r, distance_m, config)) {
          return;
        }
        if (distance_m + radius_m + other_m > config.object_width_max_m) return;
        const double gap_m = distance_m - radius_m - other_m;
        if (gap_m > best_gap_m || (gap_m == best_gap_m && (best < 0 || i > best))) return;
        best_gap_m = gap_m;
        best = i;
      });
  return best;
}

std::int32_t clump_around(const LandmarkTable& landmarks, const Candidate& candidate,
                          const MapperConfig& config) {
  if (looks_like_a_tree(*candidate.detection)) return -1;
  std::int32_t best = -1;
  double best_gap_m = kTouch_m;
  const double half_m = 0.5 * candidate.detection->width_m;
  landmarks.near(candidate.p_aligned, 0.5 * config.object_width_max_m + kTouch_m + half_m,
                 [&](std::int32_t i, const LandmarkRecord& r) {
                   if (!r.is_clump) return;
                   const double gap_m = (r.association_position() - candidate.p_aligned).norm() -
                                        extent_radius_m(r) - half_m;
                   if (gap_m > best_gap_m || (gap_m == best_gap_m && (best < 0 || i > best)))
                     return;
                   best_gap_m = gap_m;
                   best = i;
                 });
  return best;
}

}  // namespace orchard::mapping
