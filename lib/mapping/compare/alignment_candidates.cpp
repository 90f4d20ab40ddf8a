// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/alignment_candidates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/rigid_fit2.hpp"
#include "geometry/statistics.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// derived: budgets, so that a search ends within seconds: the distance of the two points of an
/// anchor, the points around it that are checked for inliers, anchors, candidates (fewer of large
/// maps, so that the trees of all candidates stay below kNumPairingsMax), fits; and after how many
/// hypotheses it is enough that kNumAgreeing anchors agree.
constexpr double kBaseline_m = 20.0;
constexpr std::size_t kNumSupport = 40;
constexpr std::size_t kNumAnchors = 30;
constexpr std::size_t kNumCandidatesMax = 400;
constexpr std::size_t kNumCandidatesMin = 24;
constexpr std::size_t kNumPairingsMax = 400 * 600;
constexpr double kNumTriedLong = 5e5;
constexpr int kNumAgreeing = 3;
constexpr int kNumFitsMax = 40;

/// An alignment that lays two points of one map on two of another, and how the points around them
/// agree.
struct AlignmentHypothesis {
  geometry::Pose2 T_a_b;
  Vector2d middle_a{0.0, 0.0};
  int num_agreeing = 0;  ///< inliers
  double sum_m2 = 0.0;
  double sum_width_m = 0.0;  ///< width differences b - a of the inliers
  double sum_width_m2 = 0.0;

  double place_m2() const { return sum_m2 / num_agreeing; }
  double width_m2() const {
    const double mean_m = sum_width_m / num_agreeing;
    return sum_width_m2 / num_agreeing - mean_m * mean_m;
  }
};

/// Log-likelihood ratio of the inlier support against the null hypothesis. The noise is estimated
/// from the inliers and, while they are few, shrunk towards that of the null hypothesis.
double agreement(const AlignmentHypothesis& h, double null_place_m2, double null_width_m2) {
  const double n = h.num_agreeing;
  const auto gain = [n](double own, double null) {
    return 0.5 * n *
           std::log(null * (n + tuning::kNullPairs) / (n * own + tuning::kNullPairs * null));
  };
  return 2.0 * gain(h.place_m2(), null_place_m2) + gain(h.width_m2(), null_width_m2);
}

/// Order in which hypotheses are refined: alternately by agreement and by number of inliers, each
/// hypothesis once. A large map has millions, of which only the first are asked for: not sorted.
class MostPromising {
 public:
  explicit MostPromising(const std::vector<AlignmentHypothesis>& hypotheses)
      : is_taken_(hypotheses.size(), false) {
    std::vector<double> places_m2, widths_m2;
    for (const AlignmentHypothesis& h : hypotheses) {
      places_m2.push_back(h.place_m2());
      widths_m2.push_back(h.width_m2());
    }
    const double place_m2 = std::max(1e-6, geometry::median(std::move(places_m2)));
    const double width_m2 = std::max(1e-6, geometry::median(std::move(widths_m2)));
    std::vector<Rank> by_agreement, by_number;
    for (std::size_t i = 0; i < hypotheses.size(); ++i) {
      const AlignmentHypothesis& h = hypotheses[i];
      by_agreement.push_back({agreement(h, place_m2, width_m2), 0.0, i});
      by_number.push_back({static_cast<double>(h.num_agreeing), -h.sum_m2, i});
    }
    queues_[0] = Queue({}, std::move(by_agreement));
    queues_[1] = Queue({}, std::move(by_number));
  }

  /// Index of the next hypothesis; none after the last.
  std::optional<std::size_t> next() {
    while (!queues_[turn_].empty()) {
      const std::size_t i = queues_[turn_].top().index;
      queues_[turn_].pop();
      turn_ = 1 - turn_;
      if (is_taken_[i]) continue;
      is_taken_[i] = true;
      return i;
    }
    return std::nullopt;
  }

 private:
  struct Rank {
    double first = 0.0, second = 0.0;  ///< the larger, the earlier
    std::size_t index = 0;             ///< of equals the smaller one first

    bool operator<(const Rank& other) const {
      return std::tie(first, second, other.index) < std::tie(other.first, other.second, index);
    }
  };
  using Queue = std::priority_queue<Rank>;

  std::array<Queue, 2> queues_;
  std::size_t turn_ = 0;
  std::vector<bool> is_taken_;
};

/// Two points of a and the points around them.
struct Anchor {
  std::size_t first = 0, second = 0;
  Vector2d middle{0.0, 0.0};
  std::vector<std::int32_t> support;
};

/// Positions and widths of the points of a map.
struct Trunks {
  const geometry::IndexedPoints& places;
  const std::vector<double>& width_m;
};

/// The farthest point from `first` within the baseline; with `along`, only within about ten degrees
/// of that axis. -1 for none.
std::int32_t far_end(const geometry::IndexedPoints& a, std::size_t first, const Vector2d* along) {
  constexpr double kAside = 0.17;  ///< derived: sine of ten degrees
  std::int32_t farthest = -1;
  double farthest_m = 0.0;
  for (const std::int32_t i : a.within(a[first], kBaseline_m)) {
    const Vector2d d = a[static_cast<std::size_t>(i)] - a[first];
    const double d_m = d.norm();
    if (d_m <= farthest_m) continue;
    if (along && std::abs(along->x() * d.y() - along->y() * d.x()) > kAside * d_m) continue;
    farthest_m = d_m;
    farthest = i;
  }
  return farthest;
}

/// Points around an anchor, at most `aside_m` from the line through its two points.
std::vector<std::int32_t> support_of(const geometry::IndexedPoints& a, const Anchor& anchor,
                                     double aside_m) {
  const Vector2d along = (a[anchor.second] - a[anchor.first]).stableNormalized();
  std::vector<std::int32_t> support;
  for (const std::int32_t i : a.nearest_few(anchor.middle, 0.6 * kBaseline_m, kNumSupport)) {
    const Vector2d d = a[static_cast<std::size_t>(i)] - anchor.middle;
    if (std::abs(along.x() * d.y() - along.y() * d.x()) <= aside_m) support.push_back(i);
  }
  return support;
}

/// Permutation of 0 to `count` - 1 in which every prefix is spread over the whole range.
std::vector<std::size_t> scattered(std::size_t count) {
  std::vector<std::size_t> order;
  const auto step = static_cast<std::size_t>(std::lround(0.618 * static_cast<double>(count)));
  std::vector<bool> taken(count, false);
  for (std::size_t k = 0, i = 0; k < count; ++k, i = (i + step) % count) {
    while (taken[i]) i = (i + 1) % count;
    taken[i] = true;
    order.push_back(i);
  }
  return order;
}

/// Anchors at `count` points spread over a: each point with the farthest one, and with the farthest
/// one along its row, because two drives may share only one row.
std::vector<Anchor> anchors_of(const geometry::IndexedPoints& a, std::size_t count) {
  std::vector<std::size_t> order(a.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return std::make_tuple(a[i].x(), a[i].y(), i) < std::make_tuple(a[j].x(), a[j].y(), j);
  });
  std::vector<Anchor> anchors;
  const std::size_t num = std::min(count, a.size());
  for (const std::size_t k : scattered(num)) {
    const std::size_t first = order[(2 * k + 1) * a.size() / (2 * num)];
    const auto near = a.nearest_few(a[first], kBaseline_m, 2);
    if (near.size() < 2) continue;
    const Vector2d step = a[static_cast<std::size_t>(near[1])] - a[first];
    const double row_step_m = step.norm();
    const Vector2d row = step.stableNormalized();
    const std::int32_t aside = far_end(a, first, nullptr), along = far_end(a, first, &row);
    for (const std::int32_t second : {aside, along}) {
      if (second < 0 || (second == along && along == aside && !anchors.empty() &&
                         anchors.back().first == first)) {
        continue;
      }
      Anchor anchor;
      anchor.first = first;
      anchor.second = static_cast<std::size_t>(second);
      anchor.middle = 0.5 * (a[first] + a[anchor.second]);
      const bool in_row = second == along && second != aside;
      anchor.support = support_of(a, anchor, in_row ? tuning::kRowHalf * row_step_m : kBaseline_m);
      anchors.push_back(std::move(anchor));
    }
  }
  return anchors;
}

/// A rotation and the two points that it lays on each other, without the angle: most hypotheses
/// are rejected, and trigonometry would cost more than the look that rejects them.
struct Laid {
  Vector2d unit_b_a{1.0, 0.0};  ///< cosine and sine of the rotation of a into b
  Vector2d middle_a{0.0, 0.0}, middle_b{0.0, 0.0};

  Vector2d in_b(const Vector2d& p_a) const {
    const Vector2d d = p_a - middle_a;
    return middle_b + Vector2d(unit_b_a.x() * d.x() - unit_b_a.y() * d.y(),
                               unit_b_a.y() * d.x() + unit_b_a.x() * d.y());
  }
};

Laid laid_on(const Vector2d& a1, const Vector2d& a2, const Vector2d& b1, const Vector2d& b2) {
  const Vector2d a = a2 - a1, b = b2 - b1;
  const Vector2d turn(a.dot(b), a.x() * b.y() - a.y() * b.x());
  return {turn.stableNormalized(), 0.5 * (a1 + a2), 0.5 * (b1 + b2)};
}

/// Inlier check: whether enough points around the anchor find partners; stops as soon as that is
/// impossible.
bool has_support(const Trunks& a, const Trunks& b, const Anchor& anchor, const Laid& laid,
                 double gate_m, AlignmentHypothesis& hypothesis) {
  const auto num = static_cast<int>(anchor.support.size());
  const int needed = std::max(3, static_cast<int>(std::ceil(tuning::kInlierFraction * num)));
  int num_left = num;
  for (const std::int32_t i : anchor.support) {
    if (hypothesis.num_agreeing + num_left < needed) return false;
    --num_left;
    const auto of_a = static_cast<std::size_t>(i);
    const Vector2d p_b = laid.in_b(a.places[of_a]);
    const std::int32_t j = b.places.nearest(p_b, gate_m);
    if (j < 0) continue;
    const auto of_b = static_cast<std::size_t>(j);
    const double wider_m = b.width_m[of_b] - a.width_m[of_a];
    ++hypothesis.num_agreeing;
    hypothesis.sum_m2 += (b.places[of_b] - p_b).squaredNorm();
    hypothesis.sum_width_m += wider_m;
    hypothesis.sum_width_m2 += wider_m * wider_m;
  }
  return hypothesis.num_agreeing >= needed;
}

bool is_allowed(const geometry::Pose2& T_a_b, const Vector2d& p_a, const AlignmentSearch& search) {
  if (search.any_place) return true;
  const Vector2d p_b = inverse_transform(T_a_b, p_a);
  return std::abs(T_a_b.yaw_rad) <= search.turn_max_rad &&
         (p_a - p_b).norm() <= search.offset_max_m;
}

/// Calls visit(b1, b2) for every pair of points of b whose distance matches the anchor's.
template <class Visit>
void for_each_counterpart(const geometry::IndexedPoints& a, const geometry::IndexedPoints& b,
                          const Anchor& anchor, const AlignmentSearch& search, Visit&& visit) {
  const double length_m = (a[anchor.second] - a[anchor.first]).norm();
  const double slack_m = std::min(0.3, search.gate_m);
  const auto fits = [&](std::int32_t i, std::int32_t j) {
    const double d_m =
        (b[static_cast<std::size_t>(i)] - b[static_cast<std::size_t>(j)]).norm() - length_m;
    return i != j && std::abs(d_m) <= slack_m;
  };
  if (!search.any_place) {
    const auto ends = b.within(a[anchor.second], search.offset_max_m);
    for (const std::int32_t i : b.within(a[anchor.first], search.offset_max_m)) {
      for (const std::int32_t j : ends) {
        if (fits(i, j)) visit(i, j);
      }
    }
    return;
  }
  std::vector<std::int32_t> ends;
  for (std::size_t i = 0; i < b.size(); ++i) {
    ends.clear();
    b.near(b[i], length_m + slack_m, [&](std::int32_t j) {
      if (fits(static_cast<std::int32_t>(i), j)) ends.push_back(j);
    });
    std::sort(ends.begin(), ends.end());
    for (const std::int32_t j : ends) visit(static_cast<std::int32_t>(i), j);
  }
}

geometry::Pose2 fit_pairs(const geometry::IndexedPoints& a, const geometry::IndexedPoints& b,
                          const std::vector<LandmarkPair>& pairs, const Vector2d& middle_a,
                          double radius_m, const geometry::Pose2& before) {
  std::vector<Vector2d> p_a, p_b;
  for (const LandmarkPair& pair : pairs) {
    if ((a[static_cast<std::size_t>(pair.a)] - middle_a).norm() > radius_m) continue;
    p_a.push_back(a[static_cast<std::size_t>(pair.a)]);
    p_b.push_back(b[static_cast<std::size_t>(pair.b)]);
  }
  if (p_a.size() < 2) return before;
  return geometry::fit_rigid(p_a, p_b).T_a_b;
}

/// Fits outwards from the anchor: distant pairs are correct only once the rotation is accurate.
AlignmentCandidate refined(const geometry::IndexedPoints& a, const geometry::IndexedPoints& b,
                           const AlignmentHypothesis& hypothesis, double gate_m) {
  AlignmentCandidate candidate{hypothesis.T_a_b, {}};
  double radius_m = 0.6 * kBaseline_m;
  double farthest_m = 0.0;
  for (const Vector2d& p_a : a.points()) {
    farthest_m = std::max(farthest_m, (p_a - hypothesis.middle_a).norm());
  }
  std::vector<std::pair<std::int32_t, std::int32_t>> last;
  for (int k = 0; k < kNumFitsMax; ++k) {
    const bool is_whole = radius_m >= farthest_m;
    candidate.pairs = is_whole ? pair_landmarks(a, b, candidate.T_a_b, gate_m)
                               : pair_landmarks_near(a, b, candidate.T_a_b, gate_m,
                                                     hypothesis.middle_a, radius_m + 2.0 * gate_m);
    std::vector<std::pair<std::int32_t, std::int32_t>> now;
    for (const LandmarkPair& pair : candidate.pairs) now.push_back({pair.a, pair.b});
    if (is_whole && now == last) break;
    last = std::move(now);
    candidate.T_a_b =
        fit_pairs(a, b, candidate.pairs, hypothesis.middle_a, radius_m, candidate.T_a_b);
    radius_m *= 1.6;
  }
  return candidate;
}

bool is_near(const geometry::Pose2& T, const geometry::Pose2& other, const Vector2d& p_a,
             double near_m, double near_rad) {
  const Vector2d p_b = inverse_transform(T, p_a);
  return (transform(other, p_b) - p_a).norm() < near_m &&
         std::abs(geometry::wrap_angle_rad(T.yaw_rad - other.yaw_rad)) < near_rad;
}

bool is_same(const geometry::Pose2& T, const geometry::Pose2& other, const Vector2d& p_a,
             double spacing_m) {
  return is_near(T, other, p_a, 0.35 * spacing_m, 0.03);
}

/// Best hypothesis of each anchor. Anchors in the shared part of the orchard agree on one
/// alignment, others give arbitrary ones.
class Agreement {
 public:
  Agreement(double gate_m, double spacing_m) : gate_m_(gate_m), spacing_m_(spacing_m) {}

  void add(const Anchor& anchor, const std::vector<AlignmentHypothesis>& hypotheses,
           std::size_t begin) {
    const AlignmentHypothesis* best = nullptr;
    double best_score = 0.0;
    const double null_place_m2 = 0.5 * gate_m_ * gate_m_;  // of a uniform disc
    for (std::size_t k = begin; k < hypotheses.size(); ++k) {
      const AlignmentHypothesis& h = hypotheses[k];
      constexpr double kNullWidth_m2 = 0.04 * 0.04;
      const double score = agreement(h, null_place_m2, kNullWidth_m2);
      if (best != nullptr && score <= best_score) continue;
      best = &h;
      best_score = score;
    }
    if (best != nullptr) best_.push_back({anchor.first, best->T_a_b, anchor.middle});
  }

  /// Whether `num` anchors at different trees agree on one alignment.
  bool is_reached(int num) const {
    for (const Best& one : best_) {
      int num_agreeing = 0;
      std::optional<std::size_t> last;  // the two anchors of a tree are adjacent
      for (const Best& other : best_) {
        if (other.first == last) continue;
        // Accuracy of a rotation computed from two trees at the baseline.
        const double turn_rad = gate_m_ / kBaseline_m;
        const double lever_m = (one.middle_a - other.middle_a).norm();
        if (!is_near(one.T_a_b, other.T_a_b, one.middle_a, 0.35 * spacing_m_ + turn_rad * lever_m,
                     2.0 * turn_rad)) {
          continue;
        }
        last = other.first;
        ++num_agreeing;
      }
      if (num_agreeing >= num) return true;
    }
    return false;
  }

 private:
  struct Best {
    std::size_t first;
    geometry::Pose2 T_a_b;
    Vector2d middle_a;
  };
  double gate_m_, spacing_m_;
  std::vector<Best> best_;
};

}  // namespace

AlignmentCandidates alignment_candidates(const geometry::IndexedPoints& a,
                                         const std::vector<double>& width_of_a_m,
                                         const geometry::IndexedPoints& b,
                                         const std::vector<double>& width_of_b_m,
                                         const AlignmentSearch& search) {
  AlignmentCandidates found;
  if (a.size() < 3 || b.size() < 3) return found;
  const double spacing_m = std::max(geometry::typical_spacing_m(a), 2.0 * search.gate_m);
  std::vector<AlignmentHypothesis> hypotheses;
  Agreement of_anchors(search.gate_m, spacing_m);
  for (const Anchor& anchor : anchors_of(a, kNumAnchors)) {
    if (found.num_tried > kNumTriedLong && of_anchors.is_reached(kNumAgreeing)) break;
    const std::size_t num_before = hypotheses.size();
    for_each_counterpart(a, b, anchor, search, [&](std::int32_t i, std::int32_t j) {
      const Vector2d &a1 = a[anchor.first], &a2 = a[anchor.second];
      const Vector2d &b1 = b[static_cast<std::size_t>(i)], &b2 = b[static_cast<std::size_t>(j)];
      const auto pose = [&] { return geometry::pose_from_two_pairs(a1, a2, b1, b2); };
      if (!search.any_place && !is_allowed(pose(), anchor.middle, search)) return;
      found.num_tried += 1.0;
      AlignmentHypothesis h;
      if (!has_support({a, width_of_a_m}, {b, width_of_b_m}, anchor, laid_on(a1, a2, b1, b2),
                       search.gate_m, h)) {
        return;
      }
      h.middle_a = anchor.middle;
      h.T_a_b = pose();
      hypotheses.push_back(h);
    });
    of_anchors.add(anchor, hypotheses, num_before);
  }
  const std::size_t num_candidates_max = std::clamp(kNumPairingsMax / std::max(a.size(), b.size()),
                                                    kNumCandidatesMin, kNumCandidatesMax);
  std::vector<geometry::Pose2> refined_from;  // hypotheses close to these are not refined
  MostPromising order(hypotheses);
  while (found.candidates.size() < num_candidates_max) {
    const std::optional<std::size_t> k = order.next();
    if (!k) break;
    const AlignmentHypothesis& h = hypotheses[*k];
    const auto known = [&](const AlignmentCandidate& candidate) {
      return is_same(h.T_a_b, candidate.T_a_b, h.middle_a, spacing_m);
    };
    const auto begun = [&](const geometry::Pose2& T) {
      return is_near(h.T_a_b, T, h.middle_a, 0.1 * spacing_m, 0.01);
    };
    if (std::any_of(found.candidates.begin(), found.candidates.end(), known) ||
        std::any_of(refined_from.begin(), refined_from.end(), begun)) {
      continue;
    }
    refined_from.push_back(h.T_a_b);
    AlignmentCandidate candidate = refined(a, b, h, search.gate_m);
    const auto same = [&](const AlignmentCandidate& other) {
      return is_same(candidate.T_a_b, other.T_a_b, h.middle_a, spacing_m);
    };
    if (candidate.pairs.size() < 3 || !is_allowed(candidate.T_a_b, h.middle_a, search) ||
        std::any_of(found.candidates.begin(), found.candidates.end(), same)) {
      continue;
    }
    found.candidates.push_back(std::move(candidate));
  }
  std::stable_sort(found.candidates.begin(), found.candidates.end(),
                   [](const AlignmentCandidate& x, const AlignmentCandidate& y) {
                     return x.pairs.size() > y.pairs.size();
                   });
  return found;
}

}  // namespace orchard::mapping
