// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/map_alignment.hpp"

#include <fmt/core.h>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "geometry/angles.hpp"
#include "mapping/compare/alignment_evidence.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr double kOddsNeeded = 7.0;  ///< a thousand to one
constexpr double kSigmasNeeded = 3.0;
constexpr double kRivalPairsFraction = 0.2;  ///< of the most pairs; those with fewer are no rivals
constexpr double kExplainedFraction = 0.5;   ///< of the trunks that both drives could observe
/// Max probability that the number of pairs arises by chance.
constexpr double kChanceAllowed = 0.01;
/// With fewer trees, objects are used too.
constexpr std::size_t kFewTrees = 10;
constexpr double kSharedFrame = 0.45;  ///< fraction of the tree spacing: no other tree is that near

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
    if (!with_objects && landmarks[i].label == detection::Label::kObject) continue;
    s.index.push_back(static_cast<std::int32_t>(i));
    places.push_back({landmarks[i].x_m, landmarks[i].y_m});
    s.trunks.width_m.push_back(landmarks[i].width_m);
    s.trunks.landmarks.push_back(&landmarks[i]);
  }
  s.trunks.places = geometry::IndexedPoints(places);
  if (view.is_known()) {
    s.trunks.missed = [&view, &of_other](const Vector2d& p, const Landmark& l) {
      return view.probability_missed(p, of_other, l);
    };
  } else {
    s.trunks.missed = [points = geometry::IndexedPoints(std::move(places))](const Vector2d& p,
                                                                            const Landmark&) {
      return is_surrounded(points, p) ? 0.0 : 1.0;
    };
  }
  return s;
}

std::size_t num_not_objects(const std::vector<Landmark>& landmarks) {
  return static_cast<std::size_t>(
      std::count_if(landmarks.begin(), landmarks.end(),
                    [](const Landmark& l) { return l.label != detection::Label::kObject; }));
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
  // About ten neighbours share a deformation, which reduces the effective number of pairs.
  constexpr double kNeighbours = 10.0;
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
  return (straight_m2 + kNeighbours * bend_m2) * information.inverse();
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

  /// Hypotheses with at least kRivalPairsFraction of the most pairs.
  std::vector<AlignmentCandidate> candidates_to_rate(std::vector<AlignmentCandidate> candidates,
                                                     std::size_t num_pairs_max) const {
    const double least = kRivalPairsFraction * static_cast<double>(num_pairs_max);
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
    const PairNoise null = null_noise(rated.noise);
    for (std::size_t k = 0; k < rated.candidates.size(); ++k) {
      const AlignmentCandidate& c = rated.candidates[k];
      rated.evidence.push_back(evidence_of(
          a_.trunks, b_.trunks, c, shrunk_noise(rated.noise[k], null, c.pairs.size()), null));
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
