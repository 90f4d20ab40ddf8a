// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/association.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/pose2.hpp"

namespace orchard::pose {
using geometry::rotation;
using geometry::transform;

namespace {

constexpr int kNumAnchors = 4;     // points whose every pair starts a hypothesis
constexpr double kRivalScore = 4;  // log-likelihood by which the best must beat a rival
constexpr double kReach = 1.5;     // of the squared gate: beyond it no corrected pose brings a pair

/// A pose and the pairs that made it.
struct Hypothesis {
  Eigen::Vector3d T_map_base;
  Eigen::Matrix3d covariance;
  std::vector<int> candidate;  // of each point, -1 = none
  int num_matched = 0;
  double score = 0.0;
};

struct Pair {
  int point = -1;
  int candidate = -1;
  double distance2 = std::numeric_limits<double>::infinity();  // in standard deviations
};

class Matcher {
 public:
  Matcher(const std::vector<ScanPoint>& points, const std::vector<AssociationCandidate>& candidates,
          const Hypothesis& start, const SlamConfig& config)
      : points_(points), candidates_(candidates), gate2_(config.gate_sigma * config.gate_sigma) {
    // Widths do not change with the pose, and no pose strays farther than the predicted one's gate:
    // which pairs are worth a look is found once.
    allowed_.resize(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
      for (std::size_t c = 0; c < candidates.size(); ++c) {
        const double sd_m = std::hypot(points[p].width_sd_m, candidates[c].width_sd_m);
        if (std::abs(points[p].width_m - candidates[c].width_m) <=
                config.gate_sigma * sd_m + config.width_gate_m &&
            distance2(start, static_cast<int>(p), static_cast<int>(c)) <= kReach * gate2_) {
          allowed_[p].push_back(static_cast<int>(c));
        }
      }
    }
  }

  /// Squared distance of a pair in standard deviations, by a pose.
  double distance2(const Hypothesis& h, int point, int candidate) {
    ++num_operations_;
    const Eigen::Vector2d offset =
        candidates_[candidate].p_map - transform(h.T_map_base, points_[point].p_base);
    return offset.dot(innovation_covariance(h, point, candidate).inverse() * offset);
  }

  void fit(Hypothesis& h, int point, int candidate, double distance2) const {
    const Eigen::Matrix<double, 2, 3> H = jacobian(h, point);
    const Eigen::Matrix2d S = innovation_covariance(h, point, candidate);
    const Eigen::Matrix<double, 3, 2> K = h.covariance * H.transpose() * S.inverse();
    h.T_map_base +=
        K * (candidates_[candidate].p_map - transform(h.T_map_base, points_[point].p_base));
    h.T_map_base.z() = geometry::wrap_angle_rad(h.T_map_base.z());
    const Eigen::Matrix3d P = h.covariance - K * S * K.transpose();
    h.covariance = 0.5 * (P + P.transpose());
    h.candidate[point] = candidate;
    ++h.num_matched;
    h.score += 0.5 * (gate2_ - distance2);
  }

  /// Adds pair after pair, the best fitting first.
  void complete(Hypothesis& h) {
    std::vector<char> taken(candidates_.size(), 0);
    for (const int c : h.candidate) {
      if (c >= 0) taken[c] = 1;
    }
    while (true) {
      Pair best;
      for (std::size_t p = 0; p < points_.size(); ++p) {
        if (h.candidate[p] >= 0) continue;
        for (const int c : allowed_[p]) {
          if (taken[c]) continue;
          const double d2 = distance2(h, static_cast<int>(p), c);
          if (d2 < best.distance2) best = {static_cast<int>(p), c, d2};
        }
      }
      if (!(best.distance2 <= gate2_)) return;
      fit(h, best.point, best.candidate, best.distance2);
      taken[best.candidate] = 1;
    }
  }

  const std::vector<int>& allowed(int point) const { return allowed_[point]; }
  double gate2() const { return gate2_; }
  std::int64_t num_operations() const { return num_operations_; }

 private:
  Eigen::Matrix<double, 2, 3> jacobian(const Hypothesis& h, int point) const {
    const Eigen::Vector2d arm = rotation(h.T_map_base.z()) * points_[point].p_base;
    Eigen::Matrix<double, 2, 3> H;
    H << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
    return H;
  }
  Eigen::Matrix2d innovation_covariance(const Hypothesis& h, int point, int candidate) const {
    const Eigen::Matrix<double, 2, 3> H = jacobian(h, point);
    const Eigen::Matrix2d R = rotation(h.T_map_base.z());
    return H * h.covariance * H.transpose() + R * points_[point].covariance * R.transpose() +
           candidates_[candidate].covariance;
  }

  const std::vector<ScanPoint>& points_;
  const std::vector<AssociationCandidate>& candidates_;
  double gate2_;
  std::vector<std::vector<int>> allowed_;
  std::int64_t num_operations_ = 0;
};

bool same_place(const Hypothesis& a, const Hypothesis& b, double distance_m) {
  return (a.T_map_base - b.T_map_base).head<2>().norm() < distance_m;
}

}  // namespace

Association associate(const std::vector<ScanPoint>& points,
                      const std::vector<AssociationCandidate>& candidates,
                      const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance,
                      const SlamConfig& config) {
  const int num_points = static_cast<int>(points.size());
  const Hypothesis start{T_map_base, covariance, std::vector<int>(points.size(), -1)};
  Matcher matcher(points, candidates, start, config);

  struct Anchor {
    int point;
    std::vector<int> candidates;
  };
  std::vector<Anchor> anchors;
  for (int p = 0; p < num_points; ++p) {
    Anchor anchor{p, {}};
    for (const int c : matcher.allowed(p)) {
      if (matcher.distance2(start, p, c) <= matcher.gate2()) anchor.candidates.push_back(c);
    }
    if (!anchor.candidates.empty()) anchors.push_back(std::move(anchor));
  }
  std::stable_sort(anchors.begin(), anchors.end(), [](const Anchor& a, const Anchor& b) {
    return a.candidates.size() < b.candidates.size();
  });
  if (anchors.size() > kNumAnchors) anchors.resize(kNumAnchors);

  std::vector<Hypothesis> hypotheses;
  for (const Anchor& anchor : anchors) {
    for (const int c : anchor.candidates) {
      const bool known =
          std::any_of(hypotheses.begin(), hypotheses.end(),
                      [&](const Hypothesis& h) { return h.candidate[anchor.point] == c; });
      if (known) continue;
      Hypothesis h = start;
      matcher.fit(h, anchor.point, c, matcher.distance2(h, anchor.point, c));
      matcher.complete(h);
      hypotheses.push_back(std::move(h));
    }
  }
  const Hypothesis* best = &start;
  for (const Hypothesis& h : hypotheses) {
    if (h.score > best->score) best = &h;
  }
  Association result;
  for (const Hypothesis& h : hypotheses) {
    if (&h != best && h.num_matched > 1 && h.score > best->score - kRivalScore &&
        !same_place(h, *best, config.gate_m)) {
      result.ambiguous = true;
    }
  }
  if (result.ambiguous) best = &start;

  result.T_map_base = best->T_map_base;
  result.covariance = best->covariance;
  result.landmark.assign(points.size(), -1);
  result.is_new.assign(points.size(), false);
  for (int p = 0; p < num_points; ++p) {
    const Eigen::Vector2d p_map = transform(best->T_map_base, points[p].p_base);
    const int matched = best->candidate[p];
    if (matched >= 0 && (candidates[matched].p_map - p_map).norm() <= config.gate_m) {
      result.landmark[p] = candidates[matched].landmark;
      ++result.num_matched;
      continue;
    }
    if (result.ambiguous) continue;
    result.is_new[p] =
        std::none_of(candidates.begin(), candidates.end(), [&](const AssociationCandidate& c) {
          return (c.p_map - p_map).norm() < config.new_landmark_m;
        });
  }
  result.num_operations = matcher.num_operations();
  return result;
}

}  // namespace orchard::pose
