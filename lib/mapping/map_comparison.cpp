// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/map_comparison.hpp"

#include <algorithm>
#include <cmath>

#include "mapping/change_odds.hpp"
#include "mapping/thicket.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;
using Eigen::Vector2d;

constexpr double kOneThing_m = 0.25;   ///< landmarks nearer than this may be one thing
constexpr double kNeverSurer = 0.995;  ///< some moved farther than is looked for
constexpr double kMissedIfAssumed = 0.005;
constexpr double kNearestOther = 0.9;  ///< of a tree spacing: what is farther away is another tree

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

bool are_trees(const Landmark& a, const Landmark& b) {
  return a.label == Label::kTree && b.label == Label::kTree;
}

/// How the pairs of two straightened maps scatter.
PairScatter scatter_of(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                       const std::vector<LandmarkPair>& pairs) {
  PairScatter scatter;
  std::vector<double> changes_m, widths_m, deviations_m;
  for (const LandmarkPair& pair : pairs) {
    deviations_m.push_back(pair.residual_m.x());
    deviations_m.push_back(pair.residual_m.y());
    changes_m.push_back(b[static_cast<std::size_t>(pair.b)].width_m -
                        a[static_cast<std::size_t>(pair.a)].width_m);
    widths_m.push_back(b[static_cast<std::size_t>(pair.b)].width_m);
  }
  scatter.position_sd_m = std::max(0.004, robust_sd(std::move(deviations_m)));
  scatter.width_common_m = median_of(changes_m);
  for (double& change_m : changes_m) change_m -= scatter.width_common_m;
  scatter.width_sd_m = std::max(0.002, robust_sd(changes_m));
  scatter.width_mean_m = median_of(widths_m);
  for (double& width_m : widths_m) width_m -= scatter.width_mean_m;
  scatter.width_spread_m = std::max(0.01, robust_sd(std::move(widths_m)));
  const double typical = typical_share(a, b, pairs);
  std::vector<double> of_trees, of_others;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const Landmark& l = a[static_cast<std::size_t>(pairs[k].a)];
    const Landmark& m = b[static_cast<std::size_t>(pairs[k].b)];
    if (l.label == Label::kObject && m.label == Label::kObject) continue;
    (are_trees(l, m) ? of_trees : of_others)
        .push_back(changes_m[k] / (seldom_factor(l, m, typical) * scatter.width_sd_m));
  }
  scatter.stray_widths_of_trees = stray_share(of_trees, scatter.stray_widths_of_trees, 100.0);
  scatter.stray_widths_of_others = stray_share(of_others, scatter.stray_widths_of_others, 20.0);
  return scatter;
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
  PairScatter scatter = scatter_of(a, b, pairs);
  scatter.spacing_m = std::max(spacing_m, gate_m);
  scatter.moved_max_m = std::min(config.moved_max_m, kNearestOther * scatter.spacing_m);

  MapComparison comparison;
  comparison.width_change_common_m = scatter.width_common_m;
  comparison.width_change_common_se_m =
      pairs.empty() ? 0.0
                    : 1.253 * scatter.width_sd_m / std::sqrt(static_cast<double>(pairs.size()));
  std::vector<std::int32_t> partner_of_a(a.size(), -1);
  std::vector<bool> has_partner_b(b.size(), false);
  // That what stood there has gone, and the later thing has come, if they are not one: 1 until
  // told.
  std::vector<double> gone(a.size(), kNeverSurer), come(b.size(), kNeverSurer);

  const auto sight_of = [&](std::size_t i, std::size_t j) {
    PairSight pair;
    pair.distance_m = (b_in_a[j] - places_a[i]).norm();
    pair.width_b_m = b[j].width_m;
    pair.width_change_m = b[j].width_m - a[i].width_m;
    pair.noise_factor = seldom_factor(a[i], b[j], typical);
    pair.both_trees = are_trees(a[i], b[j]);
    return pair;
  };
  const auto paired = [&](std::size_t i, std::size_t j) {
    const PairSight pair = sight_of(i, j);
    const PairOdds odds = odds_of(pair, scatter);
    const bool is_far =
        pair.distance_m >= config.moved_min_m &&
        pair.distance_m >= config.sigmas_min * pair.noise_factor * scatter.position_sd_m;
    const bool in_thicket = thicket_a[i] || thicket_b[j];
    if (is_far && !in_thicket && odds.replaced > 0.5) {
      gone[i] = std::min(gone[i], odds.replaced);
      come[j] = std::min(come[j], odds.replaced);
      return false;
    }
    partner_of_a[i] = static_cast<std::int32_t>(j);
    has_partner_b[j] = true;
    MapChange c;
    c.a = static_cast<std::int32_t>(i);
    c.b = static_cast<std::int32_t>(j);
    c.p_a = b_in_a[j];
    c.moved_m = pair.distance_m;
    c.width_change_m = pair.width_change_m;
    c.width_change_se_m = pair.noise_factor * scatter.width_sd_m;
    const bool is_wide = std::abs(c.width_change_m) >= config.width_change_min_m &&
                         std::abs(c.width_change_m) >= config.sigmas_min * c.width_change_se_m &&
                         (a[i].label == Label::kTree || b[j].label == Label::kTree);
    if (in_thicket) {
      c.confidence = 0.5;
    } else if (is_far && odds.moved > 0.5) {
      c.change = Change::kMoved;
      c.confidence = odds.moved;
    } else if (is_wide && odds.width_changed >= config.confidence_min) {
      c.change = c.width_change_m > 0.0 ? Change::kGrown : Change::kThinner;
      c.confidence = odds.width_changed;
    } else {
      c.confidence = odds.unchanged;
    }
    comparison.changes.push_back(c);
    return true;
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
  // What stands near an empty place and is as wide as what stood there has moved, most likely.
  struct Offer {
    double odds;
    std::size_t a, b;
  };
  std::vector<Offer> offers;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (partner_of_a[i] >= 0 || !is_compared(a[i]) || thicket_a[i]) continue;
    for (const std::int32_t near : b_in_a.within(places_a[i], scatter.moved_max_m)) {
      const auto j = static_cast<std::size_t>(near);
      if (has_partner_b[j] || !is_compared(b[j]) || thicket_b[j]) continue;
      const double moved = odds_of(sight_of(i, j), scatter).moved;
      if (moved > 0.01) offers.push_back({moved, i, j});
    }
  }
  std::stable_sort(offers.begin(), offers.end(),
                   [](const Offer& x, const Offer& y) { return x.odds > y.odds; });
  for (const Offer& offer : offers) {
    if (partner_of_a[offer.a] >= 0 || has_partner_b[offer.b]) continue;
    if (offer.odds > 0.5 && paired(offer.a, offer.b)) continue;
    gone[offer.a] = std::min(gone[offer.a], 1.0 - offer.odds);
    come[offer.b] = std::min(come[offer.b], 1.0 - offer.odds);
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
    c.confidence = gone[i] * confidence_of_absence(missed, reality(a[i]));
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
    c.confidence = come[j] * confidence_of_absence(missed, reality(b[j]));
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
