// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/map_alignment.hpp"

#include <fmt/core.h>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "geometry/angles.hpp"
#include "mapping/compare/alignment_evidence.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr double kOddsNeeded = 7.0;  ///< a thousand to one
constexpr double kSigmasNeeded = 3.0;
constexpr double kShareOfBest = 0.2;     ///< a rival pairs at least this share of the most pairs
constexpr double kShareExplained = 0.5;  ///< of the trunks that both drives could see
constexpr double kChanceAllowed = 0.01;
constexpr double kLookedAt = 0.05;  ///< a place: a tree there is missed more seldom
constexpr std::size_t kFewTrees = 10;
constexpr double kSharedFrame = 0.45;  ///< of a tree spacing: nearer no other tree can be meant

struct Selection {
  std::vector<std::int32_t> index;  ///< into the map's landmarks
  AlignmentTrunks trunks;
};

/// A place is inside a map when landmarks stand around it on all sides.
bool is_surrounded(const IndexedPoints& points, const Vector2d& p) {
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

Selection select(const std::vector<Landmark>& landmarks, bool with_objects, const DriveView& view) {
  Selection s{{}, {IndexedPoints({}), {}, {}}};
  std::vector<Vector2d> places;
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    if (!with_objects && landmarks[i].label == detection::Label::kObject) continue;
    s.index.push_back(static_cast<std::int32_t>(i));
    places.push_back({landmarks[i].x_m, landmarks[i].y_m});
    s.trunks.width_m.push_back(landmarks[i].width_m);
  }
  s.trunks.places = IndexedPoints(places);
  if (view.is_known()) {
    s.trunks.is_looked_at = [&view](const Vector2d& p) {
      return view.probability_missed(p) < kLookedAt;
    };
  } else {
    s.trunks.is_looked_at = [points = IndexedPoints(std::move(places))](const Vector2d& p) {
      return is_surrounded(points, p);
    };
  }
  return s;
}

std::size_t num_not_objects(const std::vector<Landmark>& landmarks) {
  return static_cast<std::size_t>(
      std::count_if(landmarks.begin(), landmarks.end(),
                    [](const Landmark& l) { return l.label != detection::Label::kObject; }));
}

/// Logarithm of the chance that at least `count` of Poisson events with that mean happen (an upper
/// bound, Chernoff).
double log_chance(double count, double mean) {
  if (count <= mean || mean <= 0.0) return mean <= 0.0 && count > 0.0 ? -1e9 : 0.0;
  return count - mean - count * std::log(count / mean);
}

/// Points of b that find a partner by chance wherever b is laid.
double expected_by_chance(const IndexedPoints& a, std::size_t num_b, double gate_m) {
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  for (const Vector2d& p : a.points()) {
    x0 = std::min(x0, p.x()), x1 = std::max(x1, p.x());
    y0 = std::min(y0, p.y()), y1 = std::max(y1, p.y());
  }
  const double area_m2 = (x1 - x0 + 2.0) * (y1 - y0 + 2.0);
  const double share = geometry::kPi * gate_m * gate_m * static_cast<double>(a.size()) / area_m2;
  return std::min(0.9, share) * static_cast<double>(num_b);
}

Eigen::Matrix3d covariance_of(const IndexedPoints& b, const MapAlignment& alignment) {
  // Bends are common to some ten neighbours: so many fewer pairs tell of them.
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

double apart_m(const geometry::Pose2& T, const geometry::Pose2& other, const IndexedPoints& b,
               const std::vector<LandmarkPair>& pairs) {
  Vector2d middle(0.0, 0.0);
  for (const LandmarkPair& pair : pairs) {
    middle += b[static_cast<std::size_t>(pair.b)] / static_cast<double>(pairs.size());
  }
  return (transform(T, middle) - transform(other, middle)).norm();
}

bool is_clear(const EvidenceDifference& d) {
  return d.log_odds > kOddsNeeded && d.sigmas > kSigmasNeeded;
}

}  // namespace

MapAlignment align_maps(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                        const DriveView& view_a, const DriveView& view_b,
                        const MapAlignmentConfig& config) {
  MapAlignment alignment;
  const bool with_objects = std::min(num_not_objects(a), num_not_objects(b)) < kFewTrees;
  const Selection in_a = select(a, with_objects, view_a), in_b = select(b, with_objects, view_b);
  const IndexedPoints &places_a = in_a.trunks.places, &places_b = in_b.trunks.places;
  AlignmentSearch search;
  search.any_place = config.any_place;
  search.offset_max_m = config.offset_max_m;
  search.turn_max_rad = config.turn_max_deg * geometry::kPi / 180.0;
  const double spacing_m = std::min(typical_spacing_m(places_a), typical_spacing_m(places_b));
  search.gate_m = std::clamp(0.35 * spacing_m, std::min(0.1, config.gate_m), config.gate_m);
  AlignmentCandidates candidates =
      alignment_candidates(places_a, in_a.trunks.width_m, places_b, in_b.trunks.width_m, search);
  std::vector<AlignmentCandidate>& ways = candidates.ways;
  const auto needed = static_cast<std::size_t>(std::max(2, config.min_pairs));
  if (ways.empty() || ways.front().pairs.size() < needed) {
    const std::size_t most = ways.empty() ? 0 : ways.front().pairs.size();
    alignment.reason = config.any_place
                           ? fmt::format(
                                 "at most {} trees come to lie upon each other, however the "
                                 "second map is laid on the first",
                                 most)
                           : fmt::format(
                                 "at most {} trees come to lie upon each other within {:.1f} m "
                                 "and {:.0f} degrees",
                                 most, config.offset_max_m, config.turn_max_deg);
    return alignment;
  }
  const double least = kShareOfBest * static_cast<double>(ways.front().pairs.size());
  ways.erase(std::remove_if(ways.begin(), ways.end(),
                            [&](const AlignmentCandidate& way) {
                              return static_cast<double>(way.pairs.size()) < least ||
                                     way.pairs.size() < needed;
                            }),
             ways.end());

  // Each way by the noise that its own pairs show: the right one has few pairs, perhaps, but they
  // agree better than trunks do that only stand in rows alike.
  std::vector<PairNoise> noise;
  for (const AlignmentCandidate& way : ways) {
    noise.push_back(pair_noise(in_a.trunks, in_b.trunks, way.pairs, search.gate_m));
  }
  const PairNoise by_chance = chance_noise(noise);
  std::vector<AlignmentEvidence> evidence;
  std::size_t best = 0;
  for (std::size_t k = 0; k < ways.size(); ++k) {
    evidence.push_back(evidence_of(in_a.trunks, in_b.trunks, ways[k],
                                   cautious(noise[k], by_chance, ways[k].pairs.size()), by_chance));
    if (k != best && difference(evidence[k], evidence[best]).log_odds > 0.0) best = k;
  }
  alignment.T_a_b = ways[best].T_a_b;
  alignment.pairs = ways[best].pairs;
  alignment.position_sd_m = noise[best].position_sd_m;
  double sum_m2 = 0.0;
  for (const LandmarkPair& pair : alignment.pairs) sum_m2 += pair.residual_m.squaredNorm();
  alignment.rms_m = std::sqrt(sum_m2 / static_cast<double>(alignment.pairs.size()));
  alignment.covariance = covariance_of(places_b, alignment);
  alignment.verdict = AlignmentVerdict::kAligned;

  const double chance =
      log_chance(static_cast<double>(alignment.pairs.size()) - 2.0,
                 expected_by_chance(places_a, num_judged_b(evidence[best]), search.gate_m)) +
      std::log(std::max(1.0, candidates.num_tried));
  const double share = share_explained(evidence[best], alignment.pairs.size());
  if (chance > std::log(kChanceAllowed)) {
    alignment.verdict = AlignmentVerdict::kNone;
    alignment.reason =
        fmt::format("the {} trees that come to lie upon each other may do so by chance",
                    alignment.pairs.size());
  } else if (share < kShareExplained) {
    alignment.verdict = AlignmentVerdict::kNone;
    alignment.reason = fmt::format(
        "only {:.0f} % of the trees that both drives could see come to lie upon each other",
        100.0 * share);
  }
  alignment.log_odds = 1e9;
  for (std::size_t k = 0; k < ways.size(); ++k) {
    if (k == best) continue;
    const EvidenceDifference d = difference(evidence[best], evidence[k]);
    if (d.log_odds < alignment.log_odds) {
      alignment.log_odds = d.log_odds;
      if (alignment.verdict != AlignmentVerdict::kAmbiguous) {
        alignment.rival_offset_m =
            apart_m(alignment.T_a_b, ways[k].T_a_b, places_b, alignment.pairs);
      }
    }
    if (is_clear(d) || alignment.verdict != AlignmentVerdict::kAligned) continue;
    alignment.verdict = AlignmentVerdict::kAmbiguous;
    alignment.rival_offset_m = apart_m(alignment.T_a_b, ways[k].T_a_b, places_b, alignment.pairs);
    alignment.reason = fmt::format(
        "they fit about as well when the second is shifted by another {:.1f} m ({} pairs of "
        "trees against {})",
        alignment.rival_offset_m, ways[k].pairs.size(), alignment.pairs.size());
  }
  // Rows that end alike lie well upon each other, too, when they are others. Where the frames tell
  // which trees are the same it need not be asked.
  const bool is_told = !config.any_place && apart_m(alignment.T_a_b, geometry::Pose2{}, places_b,
                                                    alignment.pairs) < kSharedFrame * spacing_m;
  if (alignment.verdict == AlignmentVerdict::kAligned && !is_told &&
      !is_clear(detail(evidence[best]))) {
    alignment.verdict = AlignmentVerdict::kAmbiguous;
    alignment.reason = fmt::format(
        "the {} trees that come to lie upon each other agree in place and width no better than "
        "other trees planted alike would",
        alignment.pairs.size());
  }
  for (LandmarkPair& pair : alignment.pairs) {
    pair.a = in_a.index[static_cast<std::size_t>(pair.a)];
    pair.b = in_b.index[static_cast<std::size_t>(pair.b)];
  }
  return alignment;
}

}  // namespace orchard::mapping
