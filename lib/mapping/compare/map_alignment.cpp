// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/map_alignment.hpp"

#include <fmt/core.h>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "mapping/compare/alignment_candidates.hpp"
#include "mapping/compare/change_posterior.hpp"
#include "mapping/kind.hpp"
#include "mapping/landmark.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr double kOddsNeeded = 7.0;         ///< derived: log of a thousand to one
constexpr double kSigmasNeeded = 3.0;       ///< derived: chance 0.003
constexpr double kExplainedFraction = 0.5;  ///< derived: most trunks that both drives could observe
constexpr double kChanceAllowed = 0.01;     ///< derived: that the number of pairs arises by chance

/// With fewer trees, objects are used too.
constexpr std::size_t kFewTrees = 10;

/// derived: fraction of the tree spacing, under a half, so that no other tree is that near.
constexpr double kSharedFrame = 0.45;

/// Trunks of one map used for registration.
struct AlignmentTrunks {
  geometry::IndexedPoints places;
  std::vector<double> width_m;
  std::vector<const Landmark*> landmarks;
  /// Probabilities that existing trunks of the other map, at positions in this map's frame, are
  /// missing from this map, given their repeat rates.
  std::function<std::vector<double>(const std::vector<Vector2d>&,
                                    const std::vector<const Landmark*>& of_other)>
      missed;
};

/// Log-likelihood ratio of each trunk, alignment hypothesis against null hypothesis (different
/// trunks in the same planting pattern); 0 for a trunk that the other drive would not have mapped.
struct AlignmentEvidence {
  std::vector<double> of_a;
  std::vector<double> of_b;
  double num_judged_b = 0.0;  ///< expected number of trunks of b that the first drive maps
};

/// Noise model of the pairs: differences of one trunk between the two maps.
struct PairNoise {
  double position_sd_m = 0.02;  ///< per axis
  double width_offset_m = 0.0;  ///< b minus a
  double width_sd_m = 0.01;
  double width_mean_m = 0.1;  ///< of all trunks of b
  double width_spread_m = 0.02;
  double gate_m = 0.5;
};

/// Difference of two log-likelihoods.
struct EvidenceDifference {
  double log_odds = 0.0;
  double sigmas = 0.0;  ///< Vuong's statistic
};

double normal_density(double deviation, double sd) {
  const double u = deviation / sd;
  return std::exp(-0.5 * u * u) / (sd * std::sqrt(2.0 * geometry::kPi));
}

EvidenceDifference sum_of(const std::vector<double>& values) {
  EvidenceDifference d;
  for (const double v : values) d.log_odds += v;
  const auto n = static_cast<double>(values.size());
  double variance = 0.0;
  for (const double v : values) {
    variance += (v - d.log_odds / n) * (v - d.log_odds / n) * n / std::max(1.0, n - 1.0);
  }
  d.sigmas = variance > 0.0 ? d.log_odds / std::sqrt(variance) : (d.log_odds > 0.0 ? 1e3 : 0.0);
  return d;
}

/// Noise of the pairs of one hypothesis.
PairNoise pair_noise(const AlignmentTrunks& a, const AlignmentTrunks& b,
                     const std::vector<LandmarkPair>& pairs, double gate_m) {
  std::vector<LandmarkPair> corrected = pairs;
  remove_common_residuals(a.places, corrected);
  std::vector<double> deviations_m, width_changes_m;
  for (const LandmarkPair& pair : corrected) {
    deviations_m.push_back(pair.residual_m.x());
    deviations_m.push_back(pair.residual_m.y());
    width_changes_m.push_back(b.width_m[static_cast<std::size_t>(pair.b)] -
                              a.width_m[static_cast<std::size_t>(pair.a)]);
  }
  PairNoise noise;
  noise.gate_m = gate_m;
  noise.position_sd_m = std::max(0.01, geometry::robust_sd(std::move(deviations_m)));
  noise.width_offset_m = geometry::median(width_changes_m);
  for (double& change_m : width_changes_m) change_m -= noise.width_offset_m;
  noise.width_sd_m = std::max(0.003, geometry::robust_sd(std::move(width_changes_m)));
  noise.width_mean_m = geometry::median(b.width_m);
  std::vector<double> spread_m = b.width_m;
  for (double& width_m : spread_m) width_m -= noise.width_mean_m;
  noise.width_spread_m = std::max(noise.width_sd_m, geometry::robust_sd(std::move(spread_m)));
  return noise;
}

/// Noise of pairs under the null hypothesis (lattice aliasing): the median over all hypotheses, or
/// uniform within the gate if there are too few.
PairNoise null_noise(const std::vector<PairNoise>& of_hypotheses) {
  constexpr std::size_t kNumHypothesesMin = 4;  // derived: the fewest with a median
  PairNoise null = of_hypotheses.front();
  if (of_hypotheses.size() < kNumHypothesesMin) {
    null.position_sd_m = 0.5 * null.gate_m;  // uniform in a disc, per axis
    null.width_sd_m = std::max(null.width_sd_m, std::sqrt(2.0) * null.width_spread_m);
    return null;
  }
  std::vector<double> positions_m, widths_m;
  for (const PairNoise& noise : of_hypotheses) {
    positions_m.push_back(noise.position_sd_m);
    widths_m.push_back(noise.width_sd_m);
  }
  null.position_sd_m = geometry::median(std::move(positions_m));
  null.width_sd_m = geometry::median(std::move(widths_m));
  return null;
}

/// Shrinks the noise of a hypothesis with few pairs towards that of the null hypothesis.
PairNoise shrunk_noise(const PairNoise& own, const PairNoise& null, std::size_t num_pairs) {
  const auto n = static_cast<double>(num_pairs);
  const auto mixed = [&](double sd, double null_sd) {
    return std::sqrt((n * sd * sd + tuning::kNullPairs * null_sd * null_sd) /
                     (n + tuning::kNullPairs));
  };
  PairNoise noise = own;
  noise.position_sd_m = mixed(own.position_sd_m, null.position_sd_m);
  noise.width_sd_m = mixed(own.width_sd_m, null.width_sd_m);
  return noise;
}

/// Which of a map's trunks have no partner in a hypothesis, in order; `side`: of that map.
std::vector<std::size_t> unpaired_of(std::size_t num, const std::vector<LandmarkPair>& pairs,
                                     std::int32_t LandmarkPair::*side) {
  std::vector<bool> is_paired(num, false);
  for (const LandmarkPair& pair : pairs) is_paired[static_cast<std::size_t>(pair.*side)] = true;
  std::vector<std::size_t> unpaired;
  for (std::size_t i = 0; i < num; ++i) {
    if (!is_paired[i]) unpaired.push_back(i);
  }
  return unpaired;
}

/// The trunks of one map that each hypothesis leaves without a partner, and the probabilities that
/// the other map misses them: of all hypotheses at once, since the other drive is looked through
/// for them.
struct Unpaired {
  std::vector<std::vector<std::size_t>> trunks;  ///< per hypothesis
  std::vector<std::vector<double>> missed;       ///< the same
};

/// `T_other_map`: from the map to the other one, per hypothesis.
Unpaired unpaired_by(const AlignmentTrunks& map, const AlignmentTrunks& other,
                     const std::vector<AlignmentCandidate>& candidates,
                     std::int32_t LandmarkPair::*side,
                     const std::vector<geometry::Pose2>& T_other_map) {
  Unpaired unpaired;
  std::vector<Vector2d> p_other;
  std::vector<const Landmark*> landmarks;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    unpaired.trunks.push_back(unpaired_of(map.places.size(), candidates[k].pairs, side));
    for (const std::size_t i : unpaired.trunks.back()) {
      p_other.push_back(transform(T_other_map[k], map.places[i]));
      landmarks.push_back(map.landmarks[i]);
    }
  }
  const std::vector<double> missed = other.missed(p_other, landmarks);
  auto begin = missed.begin();
  for (const std::vector<std::size_t>& trunks : unpaired.trunks) {
    const auto end = begin + static_cast<std::ptrdiff_t>(trunks.size());
    unpaired.missed.emplace_back(begin, end);
    begin = end;
  }
  return unpaired;
}

/// Log-likelihood ratios of all trunks for hypothesis k. `noise`: of its pairs; `null`: of the null
/// hypothesis.
AlignmentEvidence evidence_of(const AlignmentTrunks& a, const AlignmentTrunks& b,
                              const AlignmentCandidate& candidate, const Unpaired& of_a,
                              const Unpaired& of_b, std::size_t k, const PairNoise& noise,
                              const PairNoise& null) {
  AlignmentEvidence evidence;
  evidence.of_a.assign(a.places.size(), 0.0);
  evidence.of_b.assign(b.places.size(), 0.0);
  const double anywhere = 1.0 / (geometry::kPi * noise.gate_m * noise.gate_m);
  const auto any_width = [&](std::size_t j) {
    return 0.9 * normal_density(b.width_m[j] - noise.width_mean_m, noise.width_spread_m) + 0.1;
  };
  // Mean log-likelihood of a pair under the null hypothesis.
  const double of_null = -3.0 * (0.5 + 0.5 * std::log(2.0 * geometry::kPi)) -
                         2.0 * std::log(null.position_sd_m) - std::log(null.width_sd_m);
  std::vector<LandmarkPair> pairs = candidate.pairs;
  remove_common_residuals(a.places, pairs);
  for (const LandmarkPair& pair : pairs) {
    const auto i = static_cast<std::size_t>(pair.a), j = static_cast<std::size_t>(pair.b);
    const double place = normal_density(pair.residual_m.x(), noise.position_sd_m) *
                         normal_density(pair.residual_m.y(), noise.position_sd_m);
    const double width =
        normal_density(b.width_m[j] - a.width_m[i] - noise.width_offset_m, noise.width_sd_m);
    evidence.num_judged_b += 1.0;
    evidence.of_b[j] =
        std::log((1.0 - kChangedFraction) * ((1.0 - tuning::kOutlierFraction) * place * width +
                                             tuning::kOutlierFraction * anywhere * any_width(j))) -
        of_null;
  }
  for (std::size_t n = 0; n < of_a.trunks[k].size(); ++n) {
    evidence.of_a[of_a.trunks[k][n]] =
        std::log(kChangedFraction + (1.0 - kChangedFraction) * of_a.missed[k][n]);
  }
  for (std::size_t n = 0; n < of_b.trunks[k].size(); ++n) {
    const std::size_t j = of_b.trunks[k][n];
    const double missed = of_b.missed[k][n];
    evidence.num_judged_b += 1.0 - missed;
    // New, or missed by the other drive; a missed one has the likelihood of the null hypothesis.
    evidence.of_b[j] = std::log(
        kChangedFraction * anywhere * any_width(j) * std::exp(-of_null) * (1.0 - missed) + missed);
  }
  return evidence;
}

/// Log-odds of hypothesis 1 against 2; trunks that would be missed get the null likelihood.
EvidenceDifference compare_hypotheses(const AlignmentEvidence& first,
                                      const AlignmentEvidence& second) {
  std::vector<double> differences;
  const auto collect = [&](const std::vector<double>& x, const std::vector<double>& y) {
    for (std::size_t i = 0; i < x.size(); ++i) differences.push_back(x[i] - y[i]);
  };
  collect(first.of_b, second.of_b);
  collect(first.of_a, second.of_a);
  return sum_of(differences);
}

/// Log-odds of a hypothesis against the null hypothesis, from the positions and widths of b only.
EvidenceDifference log_odds_against_null(const AlignmentEvidence& evidence) {
  return sum_of(evidence.of_b);
}

/// Number of pairs divided by the expected number of b's trunks that the first drive maps.
double fraction_explained(const AlignmentEvidence& evidence, std::size_t num_pairs) {
  return evidence.num_judged_b <= 0.0 ? 0.0
                                      : static_cast<double>(num_pairs) / evidence.num_judged_b;
}

struct Selection {
  std::vector<std::int32_t> index;  ///< into the map's landmarks
  AlignmentTrunks trunks;
};

/// Whether landmarks surround a position on all sides, so that it is inside the map.
bool is_surrounded(const geometry::IndexedPoints& points, const Vector2d& p) {
  constexpr double kReach_m = 12.0, kWidestGap_rad = 2.6;
  constexpr std::size_t kNum = 10;
  std::vector<double> angles;
  for (const std::int32_t i : points.nearest_few(p, kReach_m, kNum)) {
    const Vector2d d = points[static_cast<std::size_t>(i)] - p;
    if (d.norm() > 1e-6) angles.push_back(std::atan2(d.y(), d.x()));
  }
  if (angles.size() < 4) return false;
  std::sort(angles.begin(), angles.end());
  double widest_rad = angles.front() + 2.0 * geometry::kPi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) {
    widest_rad = std::max(widest_rad, angles[i] - angles[i - 1]);
  }
  return widest_rad < kWidestGap_rad;
}

Selection select(const std::vector<Landmark>& landmarks, bool with_objects,
                 const DetectionMap& view, const DetectionMap& of_other) {
  Selection s{{}, {geometry::IndexedPoints({}), {}, {}, {}}};
  std::vector<Vector2d> places;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!with_objects && !may_be_tree(landmarks[i])) continue;
    s.index.push_back(static_cast<std::int32_t>(i));
    places.push_back({landmarks[i].x_m, landmarks[i].y_m});
    s.trunks.width_m.push_back(landmarks[i].width_m);
    s.trunks.landmarks.push_back(&landmarks[i]);
  }
  s.trunks.places = geometry::IndexedPoints(std::move(places));
  if (view.is_known()) {
    s.trunks.missed = [&view, &of_other](const std::vector<Vector2d>& p,
                                         const std::vector<const Landmark*>& landmarks_there) {
      return view.probabilities_missed(p, of_other, landmarks_there);
    };
  } else {
    s.trunks.missed = [points = s.trunks.places](const std::vector<Vector2d>& p, const auto&) {
      std::vector<double> missed;
      for (const Vector2d& there : p) missed.push_back(is_surrounded(points, there) ? 0.0 : 1.0);
      return missed;
    };
  }
  return s;
}

std::size_t num_not_objects(const std::vector<Landmark>& landmarks) {
  return static_cast<std::size_t>(std::count_if(landmarks.begin(), landmarks.end(), may_be_tree));
}

/// Log of an upper bound (Chernoff) on the probability of at least `count` Poisson events of that
/// mean.
double log_null_probability(double count, double mean) {
  if (count <= mean || mean <= 0.0) return mean <= 0.0 && count > 0.0 ? -1e9 : 0.0;
  return count - mean - count * std::log(count / mean);
}

/// Expected number of points of b that find a partner under a random alignment.
double expected_under_null(const geometry::IndexedPoints& a, double num_b, double gate_m) {
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  for (const Vector2d& p : a.points()) {
    x0 = std::min(x0, p.x()), x1 = std::max(x1, p.x());
    y0 = std::min(y0, p.y()), y1 = std::max(y1, p.y());
  }
  const double area_m2 = (x1 - x0 + 2.0) * (y1 - y0 + 2.0);
  const double fraction = geometry::kPi * gate_m * gate_m * static_cast<double>(a.size()) / area_m2;
  return std::min(0.9, fraction) * num_b;
}

Eigen::Matrix3d covariance_of(const geometry::IndexedPoints& b, const MapAlignment& alignment) {
  // Neighbours share a deformation, which reduces the effective number of pairs.
  const double straight_m2 = alignment.position_sd_m * alignment.position_sd_m;
  const double bend_m2 = std::max(0.0, 0.5 * alignment.rms_m * alignment.rms_m - straight_m2);
  const Eigen::Matrix2d R = rotation(alignment.T_a_b);
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const LandmarkPair& pair : alignment.pairs) {
    const Vector2d& p = b[static_cast<std::size_t>(pair.b)];
    Eigen::Matrix<double, 2, 3> jacobian;
    jacobian.leftCols<2>().setIdentity();
    jacobian.col(2) = R * Vector2d(-p.y(), p.x());
    information += jacobian.transpose() * jacobian;
  }
  return (straight_m2 + tuning::kBendNeighbours * bend_m2) * information.inverse();
}

double apart_m(const geometry::Pose2& T, const geometry::Pose2& other,
               const geometry::IndexedPoints& b, const std::vector<LandmarkPair>& pairs) {
  Vector2d middle(0.0, 0.0);
  for (const LandmarkPair& pair : pairs) {
    middle += b[static_cast<std::size_t>(pair.b)] / static_cast<double>(pairs.size());
  }
  return (transform(T, middle) - transform(other, middle)).norm();
}

bool is_clear(const EvidenceDifference& d) {
  return d.log_odds > kOddsNeeded && d.sigmas > kSigmasNeeded;
}

/// Alignment hypotheses with their evidence.
struct RatedHypotheses {
  std::vector<AlignmentCandidate> candidates;
  std::vector<AlignmentEvidence> evidence;
  std::vector<PairNoise> noise;
  std::size_t best = 0;
};

class MapAligner {
 public:
  MapAligner(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
             const DetectionMap& view_a, const DetectionMap& view_b,
             const MapAlignmentConfig& config)
      : config_(config),
        with_objects_(std::min(num_not_objects(a), num_not_objects(b)) < kFewTrees),
        a_(select(a, with_objects_, view_a, view_b)),
        b_(select(b, with_objects_, view_b, view_a)),
        spacing_m_(std::min(geometry::typical_spacing_m(a_.trunks.places),
                            geometry::typical_spacing_m(b_.trunks.places))) {
    search_.any_place = config.any_place;
    search_.offset_max_m = config.offset_max_m;
    search_.turn_max_rad = config.turn_max_deg * geometry::kPi / 180.0;
    search_.gate_m = std::clamp(0.35 * spacing_m_, std::min(0.1, config.gate_m), config.gate_m);
  }

  MapAlignment align() {
    AlignmentCandidates found = alignment_candidates(a_.trunks.places, a_.trunks.width_m,
                                                     b_.trunks.places, b_.trunks.width_m, search_);
    const std::size_t num_pairs_max =
        found.candidates.empty() ? 0 : found.candidates.front().pairs.size();
    if (num_pairs_max < num_pairs_min()) return refused(num_pairs_max);
    const RatedHypotheses rated =
        rate(candidates_to_rate(std::move(found.candidates), num_pairs_max));
    MapAlignment alignment = best_of(rated);
    refuse_null(rated, found.num_tried, alignment);
    refuse_rivals(rated, alignment);
    refuse_aliases(rated, alignment);
    for (LandmarkPair& pair : alignment.pairs) {
      pair.a = a_.index[static_cast<std::size_t>(pair.a)];
      pair.b = b_.index[static_cast<std::size_t>(pair.b)];
    }
    return alignment;
  }

 private:
  std::size_t num_pairs_min() const {
    return static_cast<std::size_t>(std::max(2, config_.min_pairs));
  }

  MapAlignment refused(std::size_t num_pairs_max) const {
    MapAlignment alignment;
    const auto most = static_cast<double>(num_pairs_max);
    alignment.reason =
        config_.any_place
            ? fmt::format("at most {:.0f} trees match in any alignment of the two maps", most)
            : fmt::format("at most {:.0f} trees match within {:.1f} m and {:.0f} degrees", most,
                          config_.offset_max_m, config_.turn_max_deg);
    return alignment;
  }

  /// Hypotheses with at least tuning::kRivalPairsFraction of the most pairs.
  std::vector<AlignmentCandidate> candidates_to_rate(std::vector<AlignmentCandidate> candidates,
                                                     std::size_t num_pairs_max) const {
    const double least = tuning::kRivalPairsFraction * static_cast<double>(num_pairs_max);
    candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                    [&](const AlignmentCandidate& c) {
                                      return static_cast<double>(c.pairs.size()) < least ||
                                             c.pairs.size() < num_pairs_min();
                                    }),
                     candidates.end());
    return candidates;
  }

  /// Evaluates each hypothesis with the noise of its own pairs: the correct one may have few pairs,
  /// but they agree better than pairs in a merely similar planting pattern.
  RatedHypotheses rate(std::vector<AlignmentCandidate> candidates) const {
    RatedHypotheses rated;
    rated.candidates = std::move(candidates);
    for (const AlignmentCandidate& c : rated.candidates) {
      rated.noise.push_back(pair_noise(a_.trunks, b_.trunks, c.pairs, search_.gate_m));
    }
    std::vector<geometry::Pose2> T_a_b, T_b_a;
    for (const AlignmentCandidate& c : rated.candidates) {
      T_a_b.push_back(c.T_a_b);
      T_b_a.push_back(inverse(c.T_a_b));
    }
    const Unpaired of_a =
        unpaired_by(a_.trunks, b_.trunks, rated.candidates, &LandmarkPair::a, T_b_a);
    const Unpaired of_b =
        unpaired_by(b_.trunks, a_.trunks, rated.candidates, &LandmarkPair::b, T_a_b);
    const PairNoise null = null_noise(rated.noise);
    for (std::size_t k = 0; k < rated.candidates.size(); ++k) {
      const AlignmentCandidate& c = rated.candidates[k];
      rated.evidence.push_back(evidence_of(a_.trunks, b_.trunks, c, of_a, of_b, k,
                                           shrunk_noise(rated.noise[k], null, c.pairs.size()),
                                           null));
      if (k != rated.best &&
          compare_hypotheses(rated.evidence[k], rated.evidence[rated.best]).log_odds > 0.0) {
        rated.best = k;
      }
    }
    return rated;
  }

  MapAlignment best_of(const RatedHypotheses& rated) const {
    MapAlignment alignment;
    alignment.status = AlignmentStatus::kAligned;
    alignment.T_a_b = rated.candidates[rated.best].T_a_b;
    alignment.pairs = rated.candidates[rated.best].pairs;
    alignment.position_sd_m = rated.noise[rated.best].position_sd_m;
    double sum_m2 = 0.0;
    for (const LandmarkPair& pair : alignment.pairs) sum_m2 += pair.residual_m.squaredNorm();
    alignment.rms_m = std::sqrt(sum_m2 / static_cast<double>(alignment.pairs.size()));
    alignment.covariance = covariance_of(b_.trunks.places, alignment);
    return alignment;
  }

  double distance_m(const MapAlignment& alignment, const geometry::Pose2& other) const {
    return apart_m(alignment.T_a_b, other, b_.trunks.places, alignment.pairs);
  }

  /// Rejects an alignment if its number of pairs is explained by chance, or if it pairs too few of
  /// the trunks that both drives could observe.
  void refuse_null(const RatedHypotheses& rated, double num_tried, MapAlignment& alignment) const {
    const AlignmentEvidence& evidence = rated.evidence[rated.best];
    const auto num_pairs = static_cast<double>(alignment.pairs.size());
    const double log_p =
        log_null_probability(
            num_pairs - 2.0,
            expected_under_null(a_.trunks.places, evidence.num_judged_b, search_.gate_m)) +
        std::log(std::max(1.0, num_tried));
    const double fraction = fraction_explained(evidence, alignment.pairs.size());
    if (log_p > std::log(kChanceAllowed)) {
      alignment.status = AlignmentStatus::kNone;
      alignment.reason = fmt::format("the match of {:.0f} trees may be by chance", num_pairs);
    } else if (fraction < kExplainedFraction) {
      alignment.status = AlignmentStatus::kNone;
      alignment.reason = fmt::format(
          "only {:.0f} % of the trees that both drives could observe match", 100.0 * fraction);
    }
  }

  /// Declares an alignment ambiguous if another hypothesis explains the maps about as well.
  void refuse_rivals(const RatedHypotheses& rated, MapAlignment& alignment) const {
    alignment.log_odds = 1e9;
    for (std::size_t k = 0; k < rated.candidates.size(); ++k) {
      if (k == rated.best) continue;
      const AlignmentCandidate& rival = rated.candidates[k];
      const EvidenceDifference d =
          compare_hypotheses(rated.evidence[rated.best], rated.evidence[k]);
      if (d.log_odds < alignment.log_odds) {
        alignment.log_odds = d.log_odds;
        if (alignment.status != AlignmentStatus::kAmbiguous) {
          alignment.rival_offset_m = distance_m(alignment, rival.T_a_b);
        }
      }
      if (is_clear(d) || alignment.status != AlignmentStatus::kAligned) continue;
      alignment.status = AlignmentStatus::kAmbiguous;
      alignment.rival_offset_m = distance_m(alignment, rival.T_a_b);
      alignment.reason = fmt::format(
          "they match about as well when the second map is shifted by another {:.1f} m ({:.0f} "
          "pairs of trees against {:.0f})",
          alignment.rival_offset_m, static_cast<double>(rival.pairs.size()),
          static_cast<double>(alignment.pairs.size()));
    }
  }

  /// Lattice aliasing: rows that end alike also fit when shifted to other rows. Not checked if the
  /// shared frame excludes other trees.
  void refuse_aliases(const RatedHypotheses& rated, MapAlignment& alignment) const {
    const bool is_told =
        !config_.any_place && distance_m(alignment, geometry::Pose2{}) < kSharedFrame * spacing_m_;
    if (alignment.status != AlignmentStatus::kAligned || is_told ||
        is_clear(log_odds_against_null(rated.evidence[rated.best]))) {
      return;
    }
    alignment.status = AlignmentStatus::kAmbiguous;
    alignment.reason = fmt::format(
        "the positions and widths of the {:.0f} matched trees agree no better than by chance in a "
        "regular planting",
        static_cast<double>(alignment.pairs.size()));
  }

  const MapAlignmentConfig& config_;
  bool with_objects_;
  Selection a_, b_;
  double spacing_m_;
  AlignmentSearch search_;
};

}  // namespace

MapAlignment align_maps(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                        const DetectionMap& view_a, const DetectionMap& view_b,
                        const MapAlignmentConfig& config) {
  return MapAligner(a, b, view_a, view_b, config).align();
}

}  // namespace orchard::mapping
