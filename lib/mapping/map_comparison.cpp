// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/map_comparison.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "mapping/thicket.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;
using Eigen::Vector2d;

constexpr double kShareChanged = 0.05;  ///< of trees, before looking
constexpr double kOneThing_m = 0.25;    ///< landmarks nearer than this may be one thing
constexpr double kMissedIfAssumed = 0.005;
constexpr double kWidthRange_m = 0.2;  ///< widths that grew are spread over so much

double normal_density(double deviation, double sd) {
  const double u = deviation / sd;
  return std::exp(-0.5 * u * u) / (sd * std::sqrt(2.0 * geometry::kPi));
}

std::vector<Vector2d> places_of(const std::vector<Landmark>& landmarks) {
  std::vector<Vector2d> places;
  for (const Landmark& l : landmarks) places.push_back({l.x_m, l.y_m});
  return places;
}

/// All that stands alone and is no object: what tells the trees' spacing.
std::vector<Vector2d> lone_trees(const std::vector<Landmark>& landmarks,
                                 const std::vector<char>& in_thicket) {
  std::vector<Vector2d> places;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& l = landmarks[i];
    if (l.label != Label::kObject && !in_thicket[i]) places.push_back({l.x_m, l.y_m});
  }
  return places.size() < 2 ? places_of(landmarks) : places;
}

/// How sure one may be that a thing stands there at all, from how often it was seen.
double reality(const Landmark& l) { return 1.0 - std::exp(-0.5 * l.num_observations); }

/// Scatter of pairs grows as the things were seen more seldom than is usual.
double seldom_factor(const Landmark& a, const Landmark& b, double typical) {
  const double share =
      1.0 / std::max(1, a.num_observations) + 1.0 / std::max(1, b.num_observations);
  return std::sqrt(0.5 + 0.5 * std::max(1.0, share / typical));
}

double typical_share(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                     const std::vector<LandmarkPair>& pairs) {
  std::vector<double> shares;
  for (const LandmarkPair& pair : pairs) {
    shares.push_back(1.0 / std::max(1, a[static_cast<std::size_t>(pair.a)].num_observations) +
                     1.0 / std::max(1, b[static_cast<std::size_t>(pair.b)].num_observations));
  }
  return std::max(1e-9, median_of(std::move(shares)));
}

struct WidthChanges {
  double common_m = 0.0;
  double sd_m = 0.005;
  std::size_t num = 0;
};

WidthChanges width_changes(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                           const std::vector<LandmarkPair>& pairs) {
  std::vector<double> changes_m;
  for (const LandmarkPair& pair : pairs) {
    changes_m.push_back(b[static_cast<std::size_t>(pair.b)].width_m -
                        a[static_cast<std::size_t>(pair.a)].width_m);
  }
  WidthChanges w;
  w.num = changes_m.size();
  w.common_m = median_of(changes_m);
  for (double& change_m : changes_m) change_m -= w.common_m;
  w.sd_m = std::max(0.002, robust_sd(std::move(changes_m)));
  return w;
}

/// That the thing is gone, when it was not found where it would be missed with that chance.
double confidence_of_absence(double probability_missed, double real) {
  return real * kShareChanged /
         (kShareChanged + (1.0 - kShareChanged) * std::min(1.0, probability_missed));
}

}  // namespace

std::vector<Vector2d> straightened(const IndexedPoints& a, const IndexedPoints& b,
                                   const MapAlignment& alignment) {
  constexpr std::size_t kNumNeighbours = 10, kFewest = 12;
  std::vector<Vector2d> places;
  for (const Vector2d& p : b.points()) places.push_back(alignment.T_a_b.apply(p));
  if (alignment.pairs.size() < kFewest) return places;
  std::vector<Vector2d> paired;
  for (const LandmarkPair& pair : alignment.pairs) {
    paired.push_back(a[static_cast<std::size_t>(pair.a)]);
  }
  const IndexedPoints around(std::move(paired));
  std::vector<Vector2d> result = places;
  for (std::size_t j = 0; j < places.size(); ++j) {
    std::vector<std::int32_t> near;
    for (double reach_m = 4.0; near.size() <= kNumNeighbours && reach_m <= 25.0; reach_m *= 1.8) {
      near = around.nearest_few(places[j], reach_m, kNumNeighbours + 1);
    }
    std::vector<double> x_m, y_m;
    for (const std::int32_t k : near) {
      const LandmarkPair& pair = alignment.pairs[static_cast<std::size_t>(k)];
      if (pair.b == static_cast<std::int32_t>(j)) continue;  // not straightened by itself
      x_m.push_back(pair.residual_m.x());
      y_m.push_back(pair.residual_m.y());
    }
    if (x_m.size() < kNumNeighbours / 2) continue;
    result[j] -= Vector2d(median_of(std::move(x_m)), median_of(std::move(y_m)));
  }
  return result;
}

MapComparison compare_maps(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                           const DriveView& view_a, const DriveView& view_b,
                           const MapAlignment& alignment, const ComparisonConfig& config) {
  const IndexedPoints places_a(places_of(a)), places_b(places_of(b));
  const IndexedPoints b_in_a(straightened(places_a, places_b, alignment));
  const std::vector<char> thicket_a = in_thickets(a), thicket_b = in_thickets(b);
  const double spacing_m = typical_spacing_m(IndexedPoints(lone_trees(a, thicket_a)));
  const double gate_m = std::clamp(0.35 * spacing_m, 0.1, 0.5);
  const std::vector<LandmarkPair> pairs =
      pair_landmarks(places_a, b_in_a, RigidTransform{}, gate_m);
  const double typical = typical_share(a, b, pairs);
  const WidthChanges widths = width_changes(a, b, pairs);
  const double sd_m = std::max(0.005, alignment.position_sd_m);

  MapComparison comparison;
  comparison.width_change_common_m = widths.common_m;
  comparison.width_change_common_se_m =
      widths.num == 0 ? 0.0 : 1.253 * widths.sd_m / std::sqrt(static_cast<double>(widths.num));
  std::vector<std::int32_t> partner_of_a(a.size(), -1);
  std::vector<bool> has_partner_b(b.size(), false);

  const auto paired = [&](std::size_t i, std::size_t j) {
    partner_of_a[i] = static_cast<std::int32_t>(j);
    has_partner_b[j] = true;
    const double factor = seldom_factor(a[i], b[j], typical);
    MapChange c;
    c.a = static_cast<std::int32_t>(i);
    c.b = static_cast<std::int32_t>(j);
    c.p_a = b_in_a[j];
    c.moved_m = (b_in_a[j] - places_a[i]).norm();
    c.width_change_m = b[j].width_m - a[i].width_m;
    c.width_change_se_m = factor * widths.sd_m;
    const double u = c.moved_m / (factor * sd_m);
    const double still =
        std::exp(-0.5 * u * u) / (2.0 * geometry::kPi * factor * factor * sd_m * sd_m);
    const double anywhere = 1.0 / (geometry::kPi * config.moved_max_m * config.moved_max_m);
    const double p_moved =
        kShareChanged * anywhere / (kShareChanged * anywhere + (1.0 - kShareChanged) * still);
    const double as_before = normal_density(c.width_change_m, c.width_change_se_m);
    const double p_width = kShareChanged / kWidthRange_m /
                           (kShareChanged / kWidthRange_m + (1.0 - kShareChanged) * as_before);
    if (thicket_a[i] || thicket_b[j]) {
      c.confidence = 0.5;
    } else if (c.moved_m >= config.moved_min_m && u >= config.sigmas_min) {
      c.change = Change::kMoved;
      c.confidence = p_moved;
    } else if (a[i].label == Label::kTree && b[j].label == Label::kTree &&
               std::abs(c.width_change_m) >= config.width_change_min_m &&
               std::abs(c.width_change_m) >= config.sigmas_min * c.width_change_se_m) {
      c.change = c.width_change_m > 0.0 ? Change::kGrown : Change::kThinner;
      c.confidence = p_width;
    } else {
      c.confidence = (1.0 - p_moved) * (1.0 - p_width);
    }
    comparison.changes.push_back(c);
  };
  const auto is_compared = [&](const Landmark& l) {
    return config.with_objects || l.label != Label::kObject;
  };

  for (const LandmarkPair& pair : pairs) {
    const auto i = static_cast<std::size_t>(pair.a), j = static_cast<std::size_t>(pair.b);
    if (is_compared(a[i]) || is_compared(b[j])) {
      paired(i, j);
    } else {
      partner_of_a[i] = pair.b;
      has_partner_b[j] = true;
    }
  }
  // What stands near an empty place and is as wide as what stood there has moved.
  std::vector<Vector2d> left_a, left_b;
  std::vector<std::size_t> index_a, index_b;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (partner_of_a[i] < 0 && is_compared(a[i]) && !thicket_a[i]) {
      left_a.push_back(places_a[i]);
      index_a.push_back(i);
    }
  }
  for (std::size_t j = 0; j < b.size(); ++j) {
    if (!has_partner_b[j] && is_compared(b[j]) && !thicket_b[j]) {
      left_b.push_back(b_in_a[j]);
      index_b.push_back(j);
    }
  }
  const double moved_max_m = std::min(config.moved_max_m, 0.45 * std::max(spacing_m, gate_m));
  for (const LandmarkPair& pair : pair_landmarks(IndexedPoints(left_a), IndexedPoints(left_b),
                                                 RigidTransform{}, moved_max_m)) {
    const std::size_t i = index_a[static_cast<std::size_t>(pair.a)];
    const std::size_t j = index_b[static_cast<std::size_t>(pair.b)];
    const double se_m = seldom_factor(a[i], b[j], typical) * widths.sd_m;
    if (std::abs(b[j].width_m - a[i].width_m - widths.common_m) > 3.0 * se_m) continue;
    paired(i, j);
  }

  // One thing may stand in a map as two; where the other map has something, nothing is missing.
  const double same_m = std::min(kOneThing_m, gate_m);
  const RigidTransform T_b_a = alignment.T_a_b.inverse();
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (partner_of_a[i] >= 0 || !is_compared(a[i])) continue;
    MapChange c;
    c.a = static_cast<std::int32_t>(i);
    c.p_a = places_a[i];
    if (b_in_a.nearest(places_a[i], thicket_a[i] ? kThicket_m : same_m) >= 0) {
      c.confidence = 0.5;
      comparison.changes.push_back(c);
      continue;
    }
    const double missed = config.assume_seen ? kMissedIfAssumed
                                             : view_b.probability_missed(T_b_a.apply(places_a[i]),
                                                                         view_a.visibility(a[i]));
    c.confidence = confidence_of_absence(missed, reality(a[i]));
    c.change = Change::kMissing;
    comparison.changes.push_back(c);
  }
  for (std::size_t j = 0; j < b.size(); ++j) {
    if (has_partner_b[j] || !is_compared(b[j])) continue;
    MapChange c;
    c.b = static_cast<std::int32_t>(j);
    c.p_a = b_in_a[j];
    if (places_a.nearest(b_in_a[j], thicket_b[j] ? kThicket_m : same_m) >= 0) {
      c.confidence = 0.5;
      comparison.changes.push_back(c);
      continue;
    }
    const double missed = config.assume_seen
                              ? kMissedIfAssumed
                              : view_a.probability_missed(b_in_a[j], view_b.visibility(b[j]));
    c.confidence = confidence_of_absence(missed, reality(b[j]));
    c.change = Change::kNew;
    comparison.changes.push_back(c);
  }
  for (MapChange& c : comparison.changes) {
    const bool is_absence = c.change == Change::kMissing || c.change == Change::kNew;
    if (!is_absence || c.confidence >= config.confidence_min) continue;
    c.change = Change::kNotSeen;
    c.confidence = 1.0 - c.confidence;
  }
  std::stable_sort(comparison.changes.begin(), comparison.changes.end(),
                   [](const MapChange& x, const MapChange& y) {
                     if ((x.a < 0) != (y.a < 0)) return y.a < 0;
                     return x.a < 0 ? x.b < y.b : x.a < y.a;
                   });
  return comparison;
}

int MapComparison::count(Change change) const {
  return static_cast<int>(std::count_if(
      changes.begin(), changes.end(), [change](const MapChange& c) { return c.change == change; }));
}

const char* change_text(Change change) {
  switch (change) {
    case Change::kUnchanged:
      return "unchanged";
    case Change::kMissing:
      return "missing";
    case Change::kNew:
      return "new";
    case Change::kMoved:
      return "moved";
    case Change::kGrown:
      return "grown";
    case Change::kThinner:
      return "thinner";
    case Change::kNotSeen:
      break;
  }
  return "not_seen";
}

}  // namespace orchard::mapping
