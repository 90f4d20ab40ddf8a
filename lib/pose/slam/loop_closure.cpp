// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/loop_closure.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "geometry/pose2.hpp"
#include "geometry/rigid_fit2.hpp"
#include "pose/slam/lattice_residual.hpp"

namespace orchard::pose {
using geometry::rotation;

namespace {

constexpr std::size_t kNumPairs = 16;      // pairs of recent landmarks that start hypotheses
constexpr double kPairMin_m = 3.0;         // nearer pairs determine the yaw poorly
constexpr double kPairTolerance_m = 0.35;  // max difference of the pair's distance, recent and old
constexpr std::size_t kNumRefined = 30;    // best hypotheses, which are refined
constexpr int kNumRounds = 3;              // iterations of fitting and matching
constexpr double kPriorGate2 = 16.0;       // max squared Mahalanobis distance from the prior pose
constexpr double kDistortion = 0.004;      // sd of the recent map per metre from its centroid
constexpr double kMissOdds = 2.0;          // log-odds subtracted for a tree mapped on one side only
constexpr double kMatchedFraction = 0.7;   // min matched fraction of the trees in view
constexpr double kSureFraction = 0.5;      // fraction of seen_m within which a tree is surely seen
constexpr double kCell_m = 0.25;           // one hypothesis is kept per cell
constexpr double kCell_rad = 0.02;

/// Hypothesis: a rigid motion of the recent landmarks.
struct ClosureHypothesis {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();
  double score = 0.0;
  std::vector<int> old;  // per recent landmark: index of the matched old one, -1 = none
  int num_in_view = 0;   // recent landmarks that are matched or in view of the old path
};

class ClosureMatcher {
 public:
  ClosureMatcher(const ClosureQuery& query, const SlamConfig& config) : q_(query), config_(config) {
    Eigen::Matrix3d P = q_.covariance;
    // The prior must not be tighter than the accuracy of the local map.
    P.diagonal() += Eigen::Vector3d(0.1 * 0.1, 0.1 * 0.1, 0.01 * 0.01);
    information_ = P.inverse();
    radius_m_ = 4.0 * std::sqrt(std::max(P(0, 0), P(1, 1))) + 0.5;
    yaw_max_rad_ = 4.0 * std::sqrt(P(2, 2));
    for (const ClosureLandmark& r : q_.recent) middle_ += r.p_map;
    if (!q_.recent.empty()) middle_ /= static_cast<double>(q_.recent.size());
    std::vector<Eigen::Vector2d> trees;
    for (const ClosureLandmark& o : q_.old) trees.push_back(o.p_map);
    planted_m_ = lattice_residual_sd_m(trees);
  }

  Eigen::Vector2d apply(const Eigen::Vector3d& shift, const Eigen::Vector2d& p_map) const {
    return q_.pivot + shift.head<2>() + rotation(shift.z()) * (p_map - q_.pivot);
  }
  Eigen::Vector2d undo(const Eigen::Vector3d& shift, const Eigen::Vector2d& p_map) const {
    return q_.pivot + rotation(shift.z()).transpose() * (p_map - q_.pivot - shift.head<2>());
  }
  double prior2(const Eigen::Vector3d& shift) const { return shift.dot(information_ * shift); }

  bool alike(const ClosureLandmark& a, const ClosureLandmark& b) const {
    return std::abs(a.width_m - b.width_m) <=
           config_.gate_sigma * std::hypot(a.width_sd_m, b.width_sd_m) + config_.width_gate_m;
  }

  /// Creates hypotheses that register two recent landmarks to two old ones.
  std::vector<ClosureHypothesis> hypotheses() {
    std::vector<ClosureHypothesis> found;
    std::set<std::tuple<int, int, int>> known;
    for (const auto& [i, j] : far_pairs()) {
      const ClosureLandmark& a = q_.recent[i];
      const ClosureLandmark& b = q_.recent[j];
      const Eigen::Vector2d ab = b.p_map - a.p_map;
      const double arm_m = std::max((a.p_map - q_.pivot).norm(), (b.p_map - q_.pivot).norm());
      const double radius_m = radius_m_ + yaw_max_rad_ * arm_m;
      for (const ClosureLandmark& c : q_.old) {
        ++num_operations_;
        if ((c.p_map - a.p_map).norm() > radius_m || !alike(a, c)) continue;
        for (const ClosureLandmark& d : q_.old) {
          ++num_operations_;
          const Eigen::Vector2d cd = d.p_map - c.p_map;
          if (std::abs(cd.norm() - ab.norm()) > kPairTolerance_m || !alike(b, d)) continue;
          ClosureHypothesis h;
          h.x_y_yaw.z() = geometry::pose_from_two_pairs(c.p_map, d.p_map, a.p_map, b.p_map).yaw_rad;
          if (std::abs(h.x_y_yaw.z()) > yaw_max_rad_) continue;
          const Eigen::Vector2d from = 0.5 * (a.p_map + b.p_map);
          const Eigen::Vector2d to = 0.5 * (c.p_map + d.p_map);
          h.x_y_yaw.head<2>() += to - apply(h.x_y_yaw, from);
          if (prior2(h.x_y_yaw) > kPriorGate2) continue;
          const Eigen::Vector2d middle = apply(h.x_y_yaw, middle_);
          const auto cell = [](double value, double size) {
            return static_cast<int>(std::floor(value / size));
          };
          if (known
                  .emplace(cell(middle.x(), kCell_m), cell(middle.y(), kCell_m),
                           cell(h.x_y_yaw.z(), kCell_rad))
                  .second) {
            found.push_back(std::move(h));
          }
        }
      }
    }
    return found;
  }

  /// Computes matches and log-odds of a hypothesis; `sd_m` is the repeatability of positions. The
  /// evidence is Laplace's approximation. Source: MacKay 1992, Bayesian Interpolation, section 2
  /// (Occam factor).
  void score(ClosureHypothesis& h, double sd_m) {
    h.old.assign(q_.recent.size(), -1);
    Eigen::Matrix3d told = information_;  // information on the motion, by the pose and the matches
    h.num_in_view = 0;
    std::vector<char> taken(q_.old.size(), 0);
    double score = -0.5 * prior2(h.x_y_yaw);
    for (std::size_t r = 0; r < q_.recent.size(); ++r) {
      const Eigen::Vector2d p = apply(h.x_y_yaw, q_.recent[r].p_map);
      int nearest = -1;
      double nearest_m = config_.closure_kernel_m;
      for (std::size_t o = 0; o < q_.old.size(); ++o) {
        ++num_operations_;
        const double apart_m = (q_.old[o].p_map - p).norm();
        if (taken[o] || apart_m > nearest_m || !alike(q_.recent[r], q_.old[o])) continue;
        nearest = static_cast<int>(o);
        nearest_m = apart_m;
      }
      if (nearest >= 0) {
        ++h.num_in_view;
        const double far_m = (q_.recent[r].p_map - middle_).norm();
        const double s2 = sd_m * sd_m + std::pow(kDistortion * far_m, 2);
        const double planted2 = s2 + planted_m_ * planted_m_;
        const double odds =
            std::log(planted2 / s2) - 0.5 * nearest_m * nearest_m * (1.0 / s2 - 1.0 / planted2);
        score += std::max(odds, -kMissOdds);
        const Eigen::Vector2d arm = p - q_.pivot - h.x_y_yaw.head<2>();
        Eigen::Matrix<double, 2, 3> J;
        J << 1.0, 0.0, -arm.y(), 0.0, 1.0, arm.x();
        told += J.transpose() * J / s2;
        h.old[r] = nearest;
        taken[nearest] = 1;
      } else if (in_view(p, q_.recent[r], q_.old_path)) {
        ++h.num_in_view;
        score -= kMissOdds;
      }
    }
    for (std::size_t o = 0; o < q_.old.size(); ++o) {
      if (taken[o]) continue;
      if (in_view(undo(h.x_y_yaw, q_.old[o].p_map), q_.old[o], q_.path)) score -= kMissOdds;
    }
    // Occam factor: the less the prior pose constrains the motion compared with the matches, the
    // more likely some motion fits by chance.
    h.score = score - 0.5 * std::log(told.determinant() / information_.determinant());
  }

  /// True if a landmark at p would surely have been seen from one of the places.
  bool in_view(const Eigen::Vector2d& p, const ClosureLandmark& landmark,
               const std::vector<Eigen::Vector2d>& places) {
    const double view_m = kSureFraction * landmark.seen_m;
    return std::any_of(places.begin(), places.end(), [&](const Eigen::Vector2d& place) {
      ++num_operations_;
      return (place - p).squaredNorm() <= view_m * view_m;
    });
  }

  /// Refits the rigid motion to the matches by least squares.
  void refine(ClosureHypothesis& h) const {
    std::vector<Eigen::Vector2d> p_recent, p_old;
    for (std::size_t r = 0; r < q_.recent.size(); ++r) {
      if (h.old[r] < 0) continue;
      p_recent.push_back(q_.recent[r].p_map);
      p_old.push_back(q_.old[h.old[r]].p_map);
    }
    if (p_recent.size() < 2) return;
    const geometry::RigidFit2 fit = geometry::fit_rigid(p_old, p_recent);
    h.x_y_yaw.z() = fit.T_a_b.yaw_rad;
    h.x_y_yaw.head<2>() += fit.mean_a - apply(h.x_y_yaw, fit.mean_b);
  }

  bool differ(const ClosureHypothesis& a, const ClosureHypothesis& b) const {
    return (apply(a.x_y_yaw, middle_) - apply(b.x_y_yaw, middle_)).norm() >
               2.0 * config_.closure_kernel_m ||
           std::abs(geometry::wrap_angle_rad(a.x_y_yaw.z() - b.x_y_yaw.z())) > 0.3;
  }

  /// True if there are enough old trees to estimate the fit of a wrong registration.
  bool has_lattice() const { return std::isfinite(planted_m_); }

  std::int64_t num_operations() const { return num_operations_; }

 private:
  /// Returns pairs of recent landmarks that determine the yaw well, the farthest apart first.
  std::vector<std::pair<int, int>> far_pairs() const {
    std::vector<std::tuple<double, int, int>> all;
    for (int i = 0; i < static_cast<int>(q_.recent.size()); ++i) {
      for (int j = i + 1; j < static_cast<int>(q_.recent.size()); ++j) {
        const double apart_m = (q_.recent[i].p_map - q_.recent[j].p_map).norm();
        if (apart_m >= kPairMin_m) all.emplace_back(-apart_m, i, j);
      }
    }
    std::sort(all.begin(), all.end());
    // Sample the whole list: a single false landmark far away is in many of the farthest pairs.
    std::vector<std::pair<int, int>> pairs;
    const std::size_t step = std::max<std::size_t>(1, all.size() / kNumPairs);
    for (std::size_t p = 0; p < all.size() && pairs.size() < kNumPairs; p += step) {
      pairs.emplace_back(std::get<1>(all[p]), std::get<2>(all[p]));
    }
    return pairs;
  }

  const ClosureQuery& q_;
  const SlamConfig& config_;
  Eigen::Matrix3d information_;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double radius_m_ = 0.0;
  double planted_m_ = 0.0;
  double yaw_max_rad_ = 0.0;
  std::int64_t num_operations_ = 0;
};

}  // namespace

Closure find_closure(const ClosureQuery& query, const SlamConfig& config) {
  Closure closure;
  if (query.recent.size() < kClosureTreesMin || query.old.size() < kClosureTreesMin) return closure;
  ClosureMatcher matcher(query, config);
  if (!matcher.has_lattice()) return closure;
  std::vector<ClosureHypothesis> hypotheses = matcher.hypotheses();
  const auto better = [](const ClosureHypothesis& a, const ClosureHypothesis& b) {
    return a.score > b.score;
  };
  for (ClosureHypothesis& h : hypotheses) matcher.score(h, 0.5 * config.closure_kernel_m);
  std::stable_sort(hypotheses.begin(), hypotheses.end(), better);
  if (hypotheses.size() > kNumRefined) hypotheses.resize(kNumRefined);
  for (ClosureHypothesis& h : hypotheses) {
    for (int round = 0; round < kNumRounds; ++round) {
      matcher.refine(h);
      matcher.score(h, config.closure_sd_m);
    }
  }
  std::stable_sort(hypotheses.begin(), hypotheses.end(), better);
  closure.num_operations = matcher.num_operations();
  if (hypotheses.empty()) return closure;
  const ClosureHypothesis& best = hypotheses.front();
  closure.log_odds = best.score;
  closure.shift = best.x_y_yaw;
  for (std::size_t r = 0; r < query.recent.size(); ++r) {
    if (best.old[r] < 0) continue;
    closure.matches.emplace_back(query.recent[r].landmark, query.old[best.old[r]].landmark);
  }
  if (closure.matches.size() < kClosureTreesMin ||
      static_cast<double>(closure.matches.size()) < kMatchedFraction * best.num_in_view) {
    return closure;
  }
  closure.ambiguous =
      std::any_of(hypotheses.begin() + 1, hypotheses.end(), [&](const ClosureHypothesis& other) {
        return other.score > best.score - config.closure_margin && matcher.differ(other, best);
      });
  closure.found = !closure.ambiguous && best.score >= config.closure_margin;
  return closure;
}

}  // namespace orchard::pose
