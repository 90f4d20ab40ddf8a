// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/map_comparison.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/compare/change_posterior.hpp"
#include "mapping/kind.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// derived: three parts are a clump.
constexpr int kNumOthersMin = 2;

}  // namespace

std::vector<char> in_clumps(const std::vector<Landmark>& landmarks, const ClumpConfig& config) {
  std::vector<Eigen::Vector2d> places;
  for (const Landmark& l : landmarks) {
    if (l.width_m > config.stake_m) places.push_back({l.x_m, l.y_m});
  }
  const geometry::IndexedPoints things(std::move(places));
  std::vector<char> result;
  for (const Landmark& l : landmarks) {
    const int itself = l.width_m > config.stake_m ? 1 : 0;
    const std::size_t num = things.within({l.x_m, l.y_m}, config.near_m).size();
    result.push_back(static_cast<int>(num) - itself >= kNumOthersMin ? 1 : 0);
  }
  return result;
}

using Eigen::Vector2d;

namespace {

using detection::Label;

constexpr double kCertaintyMax = 0.995;  ///< derived: the rest moved farther than the search radius
/// derived: the odds that kCertaintyMax leaves.
constexpr double kMissedIfAssumed = 0.005;

/// derived: 95 % quantile of the distance from the mean of a 2D normal distribution, in standard
/// deviations.
constexpr double kCloudSigmas = 2.448;

/// Scatter of a landmark's observations: standard deviation per axis.
double cloud_sd_m(const Landmark& l) {
  return std::sqrt(0.5 * std::max(1, l.num_observations)) * std::hypot(l.se_x_m, l.se_y_m);
}

/// Max distance of two landmarks that may be parts of one object: one, with half its width, lies
/// among the observations of the other. The suckers of a stump scatter around it, and each drive
/// divides them into different landmarks.
double same_object_m(const Landmark& a, const Landmark& b) {
  return 0.5 * (a.width_m + b.width_m) + kCloudSigmas * std::max(cloud_sd_m(a), cloud_sd_m(b));
}

/// Positions of single landmarks that are not objects, used for the tree spacing.
std::vector<Vector2d> lone_trees(const std::vector<Landmark>& landmarks,
                                 const std::vector<char>& in_clump) {
  std::vector<Vector2d> places;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    const Landmark& l = landmarks[i];
    if (may_be_tree(l) && !in_clump[i]) places.push_back({l.x_m, l.y_m});
  }
  return places.size() < 2 ? landmark_positions(landmarks) : places;
}

/// Existence probability of a landmark from its number of observations.
double existence(const Landmark& l) {
  if (l.num_observations == 0) return 1.0;  // added by a person
  return 1.0 - std::exp(-0.5 * l.num_observations);
}

/// Width difference; 0 if one map has no width.
double width_change_m(const Landmark& a, const Landmark& b) {
  return a.width_m > 0.0 && b.width_m > 0.0 ? b.width_m - a.width_m : 0.0;
}

/// Factor on the noise of a pair with fewer observations than usual.
double noise_factor(const Landmark& a, const Landmark& b, double typical) {
  const double fraction =
      1.0 / std::max(1, a.num_observations) + 1.0 / std::max(1, b.num_observations);
  return std::sqrt(0.5 + 0.5 * std::max(1.0, fraction / typical));
}

double typical_variance(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                        const std::vector<LandmarkPair>& pairs) {
  std::vector<double> fractions;
  for (const LandmarkPair& pair : pairs) {
    fractions.push_back(1.0 / std::max(1, a[static_cast<std::size_t>(pair.a)].num_observations) +
                        1.0 / std::max(1, b[static_cast<std::size_t>(pair.b)].num_observations));
  }
  return std::max(1e-9, geometry::median(std::move(fractions)));
}

bool are_trees(const Landmark& a, const Landmark& b) {
  return a.label == Label::kTree && b.label == Label::kTree;
}

/// Removes values more than three robust standard deviations from the median, repeatedly: trees
/// that grew would otherwise widen the scatter of the others.
void remove_outliers(std::vector<double>& values) {
  std::size_t before = values.size() + 1;
  while (values.size() < before) {
    before = values.size();
    const double middle = geometry::median(values);
    std::vector<double> deviations = values;
    for (double& deviation : deviations) deviation -= middle;
    const double limit = 3.0 * geometry::robust_sd(std::move(deviations));
    values.erase(std::remove_if(values.begin(), values.end(),
                                [&](double value) { return std::abs(value - middle) > limit; }),
                 values.end());
  }
}

/// Statistics of the width differences between the two maps.
struct WidthChange {
  double common_m = 0.0;
  double sd_m = 0.01;  ///< about the common difference
  std::size_t num_pairs = 0;
};

/// Estimated from pairs that are trees in both maps, because posts do not grow and the width of a
/// bush depends on the viewpoint. From all pairs only if there are too few trees.
WidthChange width_change_of(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                            const std::vector<LandmarkPair>& pairs) {
  // derived: fewer have no scatter.
  constexpr std::size_t kMinTrees = 5;
  std::vector<double> of_trees_m, of_all_m;
  for (const LandmarkPair& pair : pairs) {
    const Landmark& l = a[static_cast<std::size_t>(pair.a)];
    const Landmark& m = b[static_cast<std::size_t>(pair.b)];
    if (!(l.width_m > 0.0 && m.width_m > 0.0)) continue;
    of_all_m.push_back(m.width_m - l.width_m);
    if (are_trees(l, m)) of_trees_m.push_back(m.width_m - l.width_m);
  }
  std::vector<double>& changes_m = of_trees_m.size() >= kMinTrees ? of_trees_m : of_all_m;
  remove_outliers(changes_m);
  WidthChange change;
  change.num_pairs = changes_m.size();
  change.common_m = geometry::median(changes_m);
  for (double& change_m : changes_m) change_m -= change.common_m;
  change.sd_m = std::max(0.002, geometry::robust_sd(changes_m));
  return change;
}

/// Noise of the width difference of one trunk between the maps, from the maps' own standard errors.
struct WidthNoise {
  double scale = 0.0;  ///< factor on the standard errors, from the pairs of trees; 0: unknown

  /// Standard deviation of the width difference of a pair; 0 if a map has no standard error.
  double sd_m(const Landmark& a, const Landmark& b) const {
    const bool is_known = a.width_sd_m > 0.0 && b.width_sd_m > 0.0;
    return is_known ? scale * std::hypot(a.width_sd_m, b.width_sd_m) : 0.0;
  }
};

/// The standard errors do not include the differences between the sides of a trunk, so they are
/// scaled to the scatter of the pairs of trees.
WidthNoise width_noise_of(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                          const std::vector<LandmarkPair>& pairs, double common_m) {
  // derived: fewer have no scatter.
  constexpr std::size_t kMinTrees = 5;
  std::vector<double> deviations;
  for (const LandmarkPair& pair : pairs) {
    const Landmark& l = a[static_cast<std::size_t>(pair.a)];
    const Landmark& m = b[static_cast<std::size_t>(pair.b)];
    const double sd_m = WidthNoise{1.0}.sd_m(l, m);
    if (are_trees(l, m) && sd_m > 0.0)
      deviations.push_back((m.width_m - l.width_m - common_m) / sd_m);
  }
  if (deviations.size() < kMinTrees) return {};
  remove_outliers(deviations);
  return {std::max(1.0, geometry::robust_sd(std::move(deviations)))};
}

/// Scatter of the pairs of two maps after non-rigid residual removal.
PairScatter scatter_of(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                       const std::vector<LandmarkPair>& pairs, const WidthChange& width_change,
                       double typical) {
  PairScatter scatter;
  scatter.width_common_m = width_change.common_m;
  scatter.width_sd_m = width_change.sd_m;
  std::vector<double> widths_m, deviations_m, of_trees, of_others;
  for (const LandmarkPair& pair : pairs) {
    const Landmark& l = a[static_cast<std::size_t>(pair.a)];
    const Landmark& m = b[static_cast<std::size_t>(pair.b)];
    deviations_m.push_back(pair.residual_m.x());
    deviations_m.push_back(pair.residual_m.y());
    widths_m.push_back(m.width_m);
    if (!may_be_tree(l) && !may_be_tree(m)) continue;
    (are_trees(l, m) ? of_trees : of_others)
        .push_back((m.width_m - l.width_m - scatter.width_common_m) /
                   (noise_factor(l, m, typical) * scatter.width_sd_m));
  }
  scatter.position_sd_m = std::max(0.004, geometry::robust_sd(std::move(deviations_m)));
  scatter.width_mean_m = geometry::median(widths_m);
  for (double& width_m : widths_m) width_m -= scatter.width_mean_m;
  scatter.width_spread_m = std::max(0.01, geometry::robust_sd(std::move(widths_m)));
  scatter.width_outliers_of_trees =
      outlier_fraction(of_trees, scatter.width_outliers_of_trees, 100.0);
  scatter.width_outliers_of_others =
      outlier_fraction(of_others, scatter.width_outliers_of_others, 20.0);
  return scatter;
}

/// One of the two maps.
struct Side {
  const std::vector<Landmark>& landmarks;
  const DetectionMap& view;
  geometry::Pose2 T_map_a;  ///< from the frame of `places`, the earlier map, to this map
  geometry::IndexedPoints places;
  std::vector<char> in_clump;
  std::vector<bool> is_paired;
  std::vector<double> missed;  ///< probability that the other drive does not map it if it exists
  /// Probability that an unpaired landmark did not move but is gone or new.
  std::vector<double> not_moved;

  Side(const std::vector<Landmark>& all, const DetectionMap& seen, const geometry::Pose2& T,
       std::vector<Vector2d> places_in_a, const ClumpConfig& clump)
      : landmarks(all),
        view(seen),
        T_map_a(T),
        places(std::move(places_in_a)),
        in_clump(in_clumps(all, clump)),
        is_paired(all.size(), false),
        not_moved(all.size(), kCertaintyMax) {}
};

class MapComparer {
 public:
  MapComparer(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
              const DetectionMap& view_a, const DetectionMap& view_b, const MapAlignment& alignment,
              const ComparisonConfig& config)
      : config_(config),
        a_(a, view_a, geometry::Pose2{}, landmark_positions(a), config.clump),
        b_(b, view_b, inverse(alignment.T_a_b),
           without_local_deformation(a_.places, geometry::IndexedPoints(landmark_positions(b)),
                                     alignment.T_a_b, alignment.pairs),
           config.clump) {
    a_.missed = missed_by(b_, a_);
    b_.missed = missed_by(a_, b_);
    const double spacing_m =
        geometry::typical_spacing_m(geometry::IndexedPoints(lone_trees(a, a_.in_clump)));
    gate_m_ = std::clamp(0.35 * spacing_m, 0.1, 0.5);
    pairs_ = pair_landmarks(a_.places, b_.places, geometry::Pose2{}, gate_m_);
    typical_variance_ = typical_variance(a, b, pairs_);
    width_change_ = width_change_of(a, b, pairs_);
    width_noise_ = width_noise_of(a, b, pairs_, width_change_.common_m);
    scatter_ = scatter_of(a, b, pairs_, width_change_, typical_variance_);
    scatter_.spacing_m = std::max(spacing_m, gate_m_);
    scatter_.moved_max_m = std::min(config.moved_max_m, tuning::kNearestOther * scatter_.spacing_m);
  }

  MapComparison compare() {
    comparison_.width_change_common_m = width_change_.common_m;
    if (width_change_.num_pairs > 0) {
      // Standard error of a median: sqrt(pi / 2) times that of a mean.
      comparison_.width_change_common_se_m =
          1.253 * width_change_.sd_m / std::sqrt(static_cast<double>(width_change_.num_pairs));
    }
    pair_unmoved();
    pair_moved();
    add_absent(a_, b_, Change::kMissing);
    add_absent(b_, a_, Change::kNew);
    std::stable_sort(comparison_.changes.begin(), comparison_.changes.end(),
                     [](const MapChange& x, const MapChange& y) {
                       if ((x.a < 0) != (y.a < 0)) return y.a < 0;
                       return x.a < 0 ? x.b < y.b : x.a < y.a;
                     });
    return std::move(comparison_);
  }

 private:
  bool is_compared(const Landmark& l) const { return config_.with_objects || may_be_tree(l); }
  bool is_left(const Side& side, std::size_t i) const {
    return !side.is_paired[i] && is_compared(side.landmarks[i]);
  }

  void pair_unmoved() {
    for (const LandmarkPair& pair : pairs_) {
      const auto i = static_cast<std::size_t>(pair.a), j = static_cast<std::size_t>(pair.b);
      if (is_compared(a_.landmarks[i]) || is_compared(b_.landmarks[j])) {
        take_pair(i, j);
      } else {
        a_.is_paired[i] = b_.is_paired[j] = true;
      }
    }
  }

  /// Pairs landmarks that probably moved: an unpaired one near an empty position, with the same
  /// width.
  void pair_moved() {
    // derived: less probable moves change no confidence.
    constexpr double kProbabilityMin = 0.01;
    struct Offer {
      double probability;
      std::size_t a, b;
    };
    std::vector<Offer> offers;
    for (std::size_t i = 0; i < a_.landmarks.size(); ++i) {
      if (!is_left(a_, i) || a_.in_clump[i] || is_part_of_some(a_, i, b_)) continue;
      for (const std::int32_t near : b_.places.within(a_.places[i], scatter_.moved_max_m)) {
        const auto j = static_cast<std::size_t>(near);
        if (!is_left(b_, j) || b_.in_clump[j] || is_part_of_some(b_, j, a_)) continue;
        const double moved = change_posterior(observation_of(i, j), scatter_).moved;
        if (moved > kProbabilityMin) offers.push_back({moved, i, j});
      }
    }
    std::stable_sort(offers.begin(), offers.end(),
                     [](const Offer& x, const Offer& y) { return x.probability > y.probability; });
    for (const Offer& offer : offers) {
      if (a_.is_paired[offer.a] || b_.is_paired[offer.b]) continue;
      if (offer.probability > 0.5 && take_pair(offer.a, offer.b)) continue;
      limit_not_moved(offer.a, offer.b, 1.0 - offer.probability);
    }
  }

  void limit_not_moved(std::size_t i, std::size_t j, double not_moved) {
    a_.not_moved[i] = std::min(a_.not_moved[i], not_moved);
    b_.not_moved[j] = std::min(b_.not_moved[j], not_moved);
  }

  PairObservation observation_of(std::size_t i, std::size_t j) const {
    const Landmark &l = a_.landmarks[i], &m = b_.landmarks[j];
    PairObservation pair;
    pair.distance_m = (b_.places[j] - a_.places[i]).norm();
    pair.width_b_m = m.width_m > 0.0 ? m.width_m : l.width_m;
    pair.width_change_m = width_change_m(l, m);
    pair.noise_factor = noise_factor(l, m, typical_variance_);
    pair.width_sd_m = width_noise_.sd_m(l, m);
    pair.not_repeated = a_.missed[i] * b_.missed[j];
    pair.both_trees = are_trees(l, m);
    return pair;
  }

  /// Classifies the change of a pair; returns false if they are two objects, one of which replaced
  /// the other.
  bool take_pair(std::size_t i, std::size_t j) {
    const PairObservation pair = observation_of(i, j);
    const ChangePosterior posterior = change_posterior(pair, scatter_);
    const bool is_far =
        pair.distance_m >= config_.moved_min_m &&
        pair.distance_m > same_object_m(a_.landmarks[i], b_.landmarks[j]) &&
        pair.distance_m >= config_.sigmas_min * pair.noise_factor * scatter_.position_sd_m;
    const bool in_clump = a_.in_clump[i] || b_.in_clump[j];
    const double are_two = posterior.replaced + posterior.not_repeated;
    if (is_far && !in_clump && are_two > 0.5) {
      limit_not_moved(i, j, are_two);
      return false;
    }
    a_.is_paired[i] = b_.is_paired[j] = true;
    MapChange c;
    c.a = static_cast<std::int32_t>(i);
    c.b = static_cast<std::int32_t>(j);
    c.p_a = b_.places[j];
    c.moved_m = pair.distance_m;
    c.width_change_m = pair.width_change_m;
    c.width_change_se_m =
        pair.width_sd_m > 0.0 ? pair.width_sd_m : pair.noise_factor * scatter_.width_sd_m;
    const bool is_wide =
        std::abs(c.width_change_m) >= config_.sigmas_min * c.width_change_se_m &&
        (a_.landmarks[i].label == Label::kTree || b_.landmarks[j].label == Label::kTree);
    if (in_clump) {
      c.confidence = 0.5;
    } else if (is_far && posterior.moved > 0.5) {
      c.change = Change::kMoved;
      c.confidence = posterior.moved;
    } else if (is_wide &&
               posterior.width_changed + posterior.changed_with_all >= config_.confidence_min) {
      c.change = c.width_change_m > 0.0 ? Change::kGrown : Change::kThinner;
      c.confidence = posterior.width_changed + posterior.changed_with_all;
    } else {
      c.confidence = posterior.unchanged + posterior.changed_with_all;
    }
    comparison_.changes.push_back(c);
    return true;
  }

  /// Whether a landmark may be part of an object in the other map; then it is neither missing nor
  /// new.
  bool is_part_of_some(const Side& there, std::size_t i, const Side& other) const {
    const Landmark& l = there.landmarks[i];
    const auto near = other.places.within(there.places[i], std::max(config_.moved_max_m, gate_m_));
    return std::any_of(near.begin(), near.end(), [&](std::int32_t k) {
      const auto j = static_cast<std::size_t>(k);
      const double distance_m = (other.places[j] - there.places[i]).norm();
      const double clump_m = there.in_clump[i] ? config_.clump.reach_m : 0.0;
      return distance_m <= std::max(clump_m, same_object_m(l, other.landmarks[j]));
    });
  }

  /// Probabilities that the other drive does not map existing landmarks.
  std::vector<double> missed_by(const Side& other, const Side& there) const {
    if (config_.assume_seen) return std::vector<double>(there.landmarks.size(), kMissedIfAssumed);
    std::vector<Vector2d> p_other;
    std::vector<const Landmark*> landmarks;
    for (std::size_t i = 0; i < there.landmarks.size(); ++i) {
      p_other.push_back(transform(other.T_map_a, there.places[i]));
      landmarks.push_back(&there.landmarks[i]);
    }
    return other.view.probabilities_missed(p_other, there.view, landmarks);
  }

  /// Adds the landmarks of one map that the other lacks, as missing or new, or as not seen if the
  /// other drive did not observe the position well enough.
  void add_absent(const Side& there, const Side& other, Change change) {
    for (std::size_t i = 0; i < there.landmarks.size(); ++i) {
      if (!is_left(there, i)) continue;
      MapChange c;
      (change == Change::kMissing ? c.a : c.b) = static_cast<std::int32_t>(i);
      c.p_a = there.places[i];
      if (is_part_of_some(there, i, other)) {
        c.confidence = 0.5;
        comparison_.changes.push_back(c);
        continue;
      }
      const double absent = confidence_of_absence(there.missed[i], existence(there.landmarks[i]));
      const bool is_sure = absent >= config_.confidence_min;
      c.change = is_sure ? change : Change::kNotSeen;
      c.confidence = is_sure ? absent * there.not_moved[i] : 1.0 - absent;
      comparison_.changes.push_back(c);
    }
  }

  const ComparisonConfig& config_;
  Side a_, b_;  ///< b_ is initialized after a_, to which it is aligned
  double gate_m_ = 0.5;
  std::vector<LandmarkPair> pairs_;
  double typical_variance_ = 1.0;
  WidthChange width_change_;
  WidthNoise width_noise_;
  PairScatter scatter_;
  MapComparison comparison_;
};

}  // namespace

MapComparison compare_maps(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                           const DetectionMap& view_a, const DetectionMap& view_b,
                           const MapAlignment& alignment, const ComparisonConfig& config) {
  return MapComparer(a, b, view_a, view_b, alignment, config).compare();
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
