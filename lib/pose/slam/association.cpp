// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/association.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/pose2.hpp"
#include "pose/motion.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {

using geometry::compose;
using geometry::rotation;
using geometry::transform;
namespace {

// derived: budgets; each pair of so many points starts a hypothesis, and pairs beyond the squared
// gate by more than a correction moves them are never tested.
constexpr std::size_t kNumSeeds = 4;
constexpr double kPreGate = 1.5;

/// A pose hypothesis and the pairs that correct it.
struct ScanHypothesis {
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

/// A point of the scan at a hypothesis: the part of a pair's test that is common to all candidates.
struct PlacedPoint {
  /// `R`: rotation by the hypothesis' yaw, which all points of a scan share.
  PlacedPoint(const ScanHypothesis& h, const Eigen::Matrix2d& R, const ScanPoint& point) {
    const Eigen::Vector2d arm = R * point.p_base;
    p_map = arm + h.T_map_base.head<2>();
    H = geometry::point_jacobian(arm);
    covariance = H * h.covariance * H.transpose() + R * point.covariance * R.transpose();
  }

  /// Returns the covariance of the offset to a candidate.
  Eigen::Matrix2d innovation_covariance(const AssociationCandidate& c) const {
    return covariance + c.covariance;
  }

  /// Returns the squared Mahalanobis distance to a candidate.
  double distance2(const AssociationCandidate& c) const {
    const Eigen::Vector2d offset = c.p_map - p_map;
    return offset.dot(innovation_covariance(c).inverse() * offset);
  }

  Eigen::Vector2d p_map;
  Eigen::Matrix<double, 2, 3> H;
  Eigen::Matrix2d covariance;
};

class ScanToMapMatcher {
 public:
  ScanToMapMatcher(const std::vector<ScanPoint>& points,
                   const std::vector<AssociationCandidate>& candidates, const ScanHypothesis& start,
                   const SlamConfig& config)
      : points_(points), candidates_(candidates), gate2_(config.gate_sigma * config.gate_sigma) {
    // Widths do not depend on the pose, and all hypotheses stay within the gate of the predicted
    // pose, so the candidate pairs are selected once.
    allowed_.resize(points.size());
    const Eigen::Matrix2d R = rotation(start.T_map_base.z());
    for (std::size_t p = 0; p < points.size(); ++p) {
      const PlacedPoint placed(start, R, points[p]);
      for (std::size_t c = 0; c < candidates.size(); ++c) {
        const double d2 = distance2(placed, static_cast<int>(c));
        if (!(d2 <= kPreGate * gate2_)) continue;
        const double sd_m = std::hypot(points[p].width_sd_m, candidates[c].width_sd_m);
        if (std::abs(points[p].width_m - candidates[c].width_m) <=
                config.gate_sigma * sd_m + config.width_gate_m &&
            (candidates[c].confirmed ||
             (candidates[c].p_map - placed.p_map).norm() <= config.gate_m)) {
          allowed_[p].push_back({static_cast<int>(c), d2});
        }
      }
    }
  }

  /// Adds a pair to the hypothesis by a Kalman update of its pose.
  void fit(ScanHypothesis& h, int point, int candidate, double distance2) const {
    const PlacedPoint placed(h, rotation(h.T_map_base.z()), points_[point]);
    const AssociationCandidate& c = candidates_[candidate];
    const Eigen::Matrix2d S = placed.innovation_covariance(c);
    const Eigen::Matrix<double, 3, 2> K = h.covariance * placed.H.transpose() * S.inverse();
    h.T_map_base += K * (c.p_map - placed.p_map);
    h.T_map_base.z() = geometry::wrap_angle_rad(h.T_map_base.z());
    const Eigen::Matrix3d P = h.covariance - K * S * K.transpose();
    h.covariance = 0.5 * (P + P.transpose());
    h.candidate[point] = candidate;
    ++h.num_matched;
    h.score += 0.5 * (gate2_ - distance2);
  }

  /// Adds compatible pairs, the nearest first, until none is within the gate.
  void complete(ScanHypothesis& h) {
    std::vector<char> taken(candidates_.size(), 0);
    for (const int c : h.candidate) {
      if (c >= 0) taken[c] = 1;
    }
    while (true) {
      Pair best;
      const Eigen::Matrix2d R = rotation(h.T_map_base.z());
      for (std::size_t p = 0; p < points_.size(); ++p) {
        if (h.candidate[p] >= 0 || allowed_[p].empty()) continue;
        const PlacedPoint placed(h, R, points_[p]);
        for (const Allowed& pair : allowed_[p]) {
          if (taken[pair.candidate]) continue;
          const double d2 = distance2(placed, pair.candidate);
          if (d2 < best.distance2) best = {static_cast<int>(p), pair.candidate, d2};
        }
      }
      if (!(best.distance2 <= gate2_)) return;
      fit(h, best.point, best.candidate, best.distance2);
      taken[best.candidate] = 1;
    }
  }

  /// Creates a hypothesis from each pair of the least ambiguous points: those with the fewest pairs
  /// within the gate.
  std::vector<ScanHypothesis> hypotheses(const ScanHypothesis& start) {
    struct Seed {
      int point;
      std::vector<int> candidates;
    };
    std::vector<Seed> seeds;
    for (std::size_t p = 0; p < points_.size(); ++p) {
      Seed seed{static_cast<int>(p), {}};
      for (const Allowed& pair : allowed_[p]) {
        if (pair.start_distance2 <= gate2_) seed.candidates.push_back(pair.candidate);
      }
      if (!seed.candidates.empty()) seeds.push_back(std::move(seed));
    }
    std::stable_sort(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) {
      return a.candidates.size() < b.candidates.size();
    });
    if (seeds.size() > kNumSeeds) seeds.resize(kNumSeeds);
    const Eigen::Matrix2d R = rotation(start.T_map_base.z());
    std::vector<ScanHypothesis> found;
    for (const Seed& seed : seeds) {
      for (const int c : seed.candidates) {
        const bool known = std::any_of(found.begin(), found.end(), [&](const ScanHypothesis& h) {
          return h.candidate[seed.point] == c;
        });
        if (known) continue;
        ScanHypothesis h = start;
        const PlacedPoint placed(start, R, points_[seed.point]);
        fit(h, seed.point, c, distance2(placed, c));
        complete(h);
        found.push_back(std::move(h));
      }
    }
    return found;
  }

  std::int64_t num_operations() const { return num_operations_; }

 private:
  double distance2(const PlacedPoint& placed, int candidate) {
    ++num_operations_;
    return placed.distance2(candidates_[candidate]);
  }

  /// A candidate within the pre-gate of a point.
  struct Allowed {
    int candidate = -1;
    double start_distance2 = 0.0;  ///< at the predicted pose
  };

  const std::vector<ScanPoint>& points_;
  const std::vector<AssociationCandidate>& candidates_;
  double gate2_;
  std::vector<std::vector<Allowed>> allowed_;
  std::int64_t num_operations_ = 0;
};

/// True if a hypothesis at another position explains the scan about as well as the best one.
bool has_rival(const ScanHypothesis& best, const std::vector<ScanHypothesis>& hypotheses,
               double distance_m) {
  return std::any_of(hypotheses.begin(), hypotheses.end(), [&](const ScanHypothesis& h) {
    return &h != &best && h.num_matched > 1 && h.score > best.score - kRivalScore &&
           (h.T_map_base - best.T_map_base).head<2>().norm() >= distance_m;
  });
}

/// True if the point is far enough from all candidates to be a new object.
bool is_new(const Eigen::Vector2d& p_map, const std::vector<AssociationCandidate>& candidates,
            double distance_m) {
  return std::none_of(candidates.begin(), candidates.end(), [&](const AssociationCandidate& c) {
    return (c.p_map - p_map).norm() < distance_m;
  });
}

// physical: trunks are not round (fractions of the width), less so where a nearer object occludes
// one side; crates and bushes have no well-defined centre [m]; no scanner measures a width better.
constexpr double kObservationSd_widths = 0.1;
constexpr double kOccludedSd_widths = 0.25;
constexpr double kObjectSd_m = 0.05;
constexpr double kWidthSdMin_m = 0.02;

// derived: a beam farther from its scan's stamp has another clock; a millimetre, squared.
constexpr double kSweepMax_s = 0.5;
constexpr double kVarianceMin = 1e-6;

bool usable(const detection::Detection& t, const SlamConfig& config) {
  return std::isfinite(t.centre_x_m) && std::isfinite(t.centre_y_m) && std::isfinite(t.width_m) &&
         std::isfinite(t.width_sd_m) && std::isfinite(t.covariance[0]) &&
         std::isfinite(t.covariance[1]) && std::isfinite(t.covariance[2]) &&
         std::hypot(t.centre_x_m, t.centre_y_m) <= config.observation_range_max_m &&
         t.width_m >= 0.0 && t.width_m <= config.width_max_m;
}

double floor_sd_m(const detection::Detection& t, const SlamConfig& config) {
  double sd_m = std::hypot(config.observation_sd_m, kObservationSd_widths * t.width_m);
  if (t.occlusion != 0) sd_m = std::hypot(sd_m, kOccludedSd_widths * t.width_m);
  if (t.label == detection::Label::kObject) sd_m = std::hypot(sd_m, kObjectSd_m);
  return sd_m;
}

}  // namespace

Association associate(const std::vector<ScanPoint>& points,
                      const std::vector<AssociationCandidate>& candidates,
                      const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance,
                      const SlamConfig& config) {
  const ScanHypothesis start{T_map_base, covariance, std::vector<int>(points.size(), -1)};
  ScanToMapMatcher matcher(points, candidates, start, config);
  const std::vector<ScanHypothesis> hypotheses = matcher.hypotheses(start);
  const ScanHypothesis* best = &start;
  for (const ScanHypothesis& h : hypotheses) {
    if (h.score > best->score) best = &h;
  }
  Association result;
  result.ambiguous = has_rival(*best, hypotheses, config.gate_m);
  if (result.ambiguous) best = &start;
  result.T_map_base = best->T_map_base;
  result.covariance = best->covariance;
  result.landmark.assign(points.size(), -1);
  result.is_new.assign(points.size(), false);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Eigen::Vector2d p_map = transform(best->T_map_base, points[p].p_base);
    const int matched = best->candidate[p];
    if (matched >= 0 && (candidates[matched].p_map - p_map).norm() <= config.gate_m) {
      result.landmark[p] = candidates[matched].landmark;
      ++result.num_matched;
    } else if (!result.ambiguous) {
      result.is_new[p] = is_new(p_map, candidates, config.new_landmark_m);
    }
  }
  result.num_operations = matcher.num_operations();
  return result;
}

std::vector<ScanPoint> scan_points(const detection::Detections& seen, const ScanMotionState& motion,
                                   double noise, const SlamConfig& config) {
  std::vector<ScanPoint> points;
  points.reserve(seen.trunks.size());
  for (const detection::Detection& t : seen.trunks) {
    if (!usable(t, config)) continue;
    double dt_s = (t.utime - seen.utime) * 1e-6;
    if (std::abs(dt_s) > kSweepMax_s) dt_s = 0.0;
    const Eigen::Vector3d T_scan_beam = arc_motion(motion.speed_mps, motion.yaw_rate_radps, dt_s);
    const Eigen::Vector3d T_keyframe_beam = compose(motion.T_keyframe_scan, T_scan_beam);
    const Eigen::Matrix2d R = rotation(T_keyframe_beam.z());
    ScanPoint point;
    point.p_base = transform(T_keyframe_beam, {t.centre_x_m, t.centre_y_m});
    Eigen::Matrix2d C;
    C << std::max(t.covariance[0], kVarianceMin), t.covariance[1], t.covariance[1],
        std::max(t.covariance[2], kVarianceMin);
    if (C.determinant() < kVarianceMin * kVarianceMin) C(0, 1) = C(1, 0) = 0.0;
    // Of the motion since the keyframe.
    const Eigen::Matrix<double, 2, 3> H =
        geometry::point_jacobian(point.p_base - motion.T_keyframe_scan.head<2>());
    point.scan_covariance = R * C * R.transpose() + H * motion.covariance * H.transpose();
    point.floor_sd_m = floor_sd_m(t, config);
    point.covariance = noise * (point.scan_covariance +
                                point.floor_sd_m * point.floor_sd_m * Eigen::Matrix2d::Identity());
    point.width_m = t.width_m;
    point.width_sd_m = std::max(t.width_sd_m, kWidthSdMin_m);
    if (t.occlusion != 0) point.width_sd_m = std::hypot(point.width_sd_m, t.width_m);
    points.push_back(point);
  }
  return points;
}

}  // namespace orchard::pose
