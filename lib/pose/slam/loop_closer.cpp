// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/loop_closer.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "geometry/point_grid.hpp"
#include "geometry/pose2.hpp"
#include "geometry/rigid_fit2.hpp"
#include "pose/slam/slam_map.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {

using geometry::inverse_transform;
using geometry::rotation;
namespace {

// derived: budgets of trees whose neighbours define the shifts, and that are tested per shift; the
// neighbours in the row and in the next one; the lower quartile of the squared distance of a 2-D
// Gaussian, in units of the variance, -2 ln(3/4). A shift contains the irregularity of its two
// trees, which a registration averages out.
constexpr std::size_t kNumTreesMin = 4;
constexpr std::size_t kNumBases = 24;
constexpr std::size_t kNumMoved = 48;
constexpr std::size_t kNumNeighbours = 3;
constexpr double kQuartile2 = 0.5753641449;
constexpr double kMoveVariances = 2.0;
constexpr double kReach_m = 4.0;  // derived: first radius of a search that doubles: a row's width

using geometry::IndexedPoints;

/// Returns the trees nearest to a point but for one, the nearest first.
std::vector<std::int32_t> nearest(const IndexedPoints& trees, const Eigen::Vector2d& p,
                                  std::int32_t but_for, std::size_t num) {
  const std::size_t wanted = std::min(num, trees.size() - 1);
  for (double reach_m = kReach_m;; reach_m *= 2.0) {
    std::vector<std::int32_t> found = trees.nearest_few(p, reach_m, wanted + 1);
    found.erase(std::remove(found.begin(), found.end(), but_for), found.end());
    if (found.size() < wanted) continue;
    found.resize(wanted);
    return found;
  }
}

/// See lattice_residual_sd_m().
double residual_sd_m(const IndexedPoints& trees) {
  if (trees.size() < kNumTreesMin) return std::numeric_limits<double>::infinity();
  const std::size_t base_step = 1 + (trees.size() - 1) / kNumBases;
  const std::size_t moved_step = 1 + (trees.size() - 1) / kNumMoved;
  std::vector<double> distances2;
  for (std::size_t base = 0; base < trees.size(); base += base_step) {
    const auto own = static_cast<std::int32_t>(base);
    for (const std::int32_t neighbour : nearest(trees, trees[base], own, kNumNeighbours)) {
      const Eigen::Vector2d move = trees[static_cast<std::size_t>(neighbour)] - trees[base];
      for (std::size_t m = 0; m < trees.size(); m += moved_step) {
        if (m == base) continue;  // coincides with its neighbour by construction
        const Eigen::Vector2d moved = trees[m] + move;
        const auto at = nearest(trees, moved, static_cast<std::int32_t>(m), 1).front();
        distances2.push_back((trees[static_cast<std::size_t>(at)] - moved).squaredNorm());
      }
    }
  }
  const auto quartile = distances2.begin() + static_cast<std::ptrdiff_t>(distances2.size() / 4);
  std::nth_element(distances2.begin(), quartile, distances2.end());
  return std::sqrt(*quartile / kQuartile2 / kMoveVariances);
}

// derived: budgets of pairs, of hypotheses that are scored and refined, one for each cell, of
// comparisons, so that one search ends within a second, and of rounds; a nearer pair determines the
// yaw poorly; rounding of a reach; four standard deviations of the prior pose.
constexpr std::size_t kNumPairs = 16;
constexpr std::size_t kNumScored = 4000;
constexpr std::int64_t kSearchOperationsMax = 20'000'000;
constexpr double kPairMin_m = 3.0;
constexpr double kPairMargin_m = 1e-6;
constexpr std::size_t kNumRefined = 30;
constexpr int kNumRounds = 3;
constexpr double kPriorGate2 = 16.0;
constexpr double kCell_m = 0.25;
constexpr double kCell_rad = 0.02;

/// Hypothesis: a rigid motion of the recent landmarks.
struct ClosureHypothesis {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();
  double score = 0.0;
  int num_votes = 1;     // pairs of landmarks that tell this motion
  std::vector<int> old;  // per recent landmark: index of the matched old one, -1 = none
  int num_in_view = 0;   // recent landmarks that are matched or in view of the old path
};

class ClosureMatcher {
 public:
  ClosureMatcher(const ClosureQuery& query, const SlamConfig& config)
      : q_(query),
        config_(config),
        old_(points_of(query.old)),
        old_path_(query.old_path),
        path_(query.path) {
    Eigen::Matrix3d P = q_.covariance;
    // The prior must not be tighter than the accuracy of the local map.
    P.diagonal() += Eigen::Vector3d(0.1 * 0.1, 0.1 * 0.1, 0.01 * 0.01);
    information_ = P.inverse();
    radius_m_ = 4.0 * std::sqrt(std::max(P(0, 0), P(1, 1))) + 0.5;
    yaw_max_rad_ = 4.0 * std::sqrt(P(2, 2));
    for (const ClosureLandmark& r : q_.recent) middle_ += r.p_map;
    if (!q_.recent.empty()) middle_ /= static_cast<double>(q_.recent.size());
    planted_m_ = residual_sd_m(old_);
    for (const Eigen::Vector2d& p : q_.path) {
      path_reach_m_ = std::max(path_reach_m_, (p - middle_).norm());
    }
    double seen_most_m = 0.0;
    for (const ClosureLandmark& o : q_.old) seen_most_m = std::max(seen_most_m, o.seen_m);
    path_reach_m_ += kSurelySeenFraction * seen_most_m;
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
    std::map<std::tuple<int, int, int>, std::size_t> known;
    for (const auto& [i, j] : far_pairs()) {
      const ClosureLandmark& a = q_.recent[i];
      const ClosureLandmark& b = q_.recent[j];
      const Eigen::Vector2d ab = b.p_map - a.p_map;
      const double arm_m = std::max((a.p_map - q_.pivot).norm(), (b.p_map - q_.pivot).norm());
      const double radius_m = radius_m_ + yaw_max_rad_ * arm_m;
      // The other end lies on an arc about c, as long as the heading may be off.
      const double chord_m =
          2.0 * std::sin(0.5 * std::min(yaw_max_rad_, geometry::kPi)) * ab.norm();
      const bool is_arc = chord_m < ab.norm();
      const double reach_m = kPairMargin_m + kPairTolerance_m + (is_arc ? chord_m : ab.norm());
      for (const int i_c : old_.within(a.p_map, radius_m)) {
        if (is_beyond_budget()) return found;
        const ClosureLandmark& c = q_.old[i_c];
        ++num_operations_;
        if (!alike(a, c)) continue;
        for (const int i_d : old_.within(is_arc ? c.p_map + ab : c.p_map, reach_m)) {
          const ClosureLandmark& d = q_.old[i_d];
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
          const auto [known_at, is_new] =
              known.emplace(std::tuple(cell(middle.x(), kCell_m), cell(middle.y(), kCell_m),
                                       cell(h.x_y_yaw.z(), kCell_rad)),
                            found.size());
          if (is_new) {
            found.push_back(std::move(h));
          } else {
            ++found[known_at->second].num_votes;
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
      for (const int o : old_.within(p, nearest_m)) {
        ++num_operations_;
        const double apart_m = (q_.old[o].p_map - p).norm();
        if (taken[o] || apart_m > nearest_m || !alike(q_.recent[r], q_.old[o])) continue;
        nearest = o;
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
        const Eigen::Matrix<double, 2, 3> J = geometry::point_jacobian(arm);
        told += J.transpose() * J / s2;
        h.old[r] = nearest;
        taken[nearest] = 1;
      } else if (in_view(p, q_.recent[r], old_path_)) {
        ++h.num_in_view;
        score -= kMissOdds;
      }
    }
    old_.near(apply(h.x_y_yaw, middle_), path_reach_m_, [&](int o) {
      if (taken[o]) return;
      if (in_view(undo(h.x_y_yaw, q_.old[o].p_map), q_.old[o], path_)) score -= kMissOdds;
    });
    // Occam factor: the less the prior pose constrains the motion compared with the matches, the
    // more likely some motion fits by chance.
    h.score = score - 0.5 * std::log(told.determinant() / information_.determinant());
  }

  /// True if a landmark at p would surely have been seen from one of the places.
  bool in_view(const Eigen::Vector2d& p, const ClosureLandmark& landmark,
               const geometry::IndexedPoints& places) {
    ++num_operations_;
    return places.nearest(p, kSurelySeenFraction * landmark.seen_m) >= 0;
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
  bool is_beyond_budget() const { return num_operations_ > kSearchOperationsMax; }

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

  static std::vector<Eigen::Vector2d> points_of(const std::vector<ClosureLandmark>& landmarks) {
    std::vector<Eigen::Vector2d> points;
    for (const ClosureLandmark& l : landmarks) points.push_back(l.p_map);
    return points;
  }

  const ClosureQuery& q_;
  const SlamConfig& config_;
  geometry::IndexedPoints old_, old_path_, path_;
  double path_reach_m_ = 0.0;  ///< from middle_: beyond it no old landmark is in view of the path
  Eigen::Matrix3d information_;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
  double radius_m_ = 0.0;
  double planted_m_ = 0.0;
  double yaw_max_rad_ = 0.0;
  std::int64_t num_operations_ = 0;
};

// derived: travel between two searches [m], more after one of many operations, so that their cost
// per metre is bounded, to a tenth of that of a scan a metre; with so many older landmarks tracked
// the pose needs no closure; one is tried again only when the graph has grown by a fiftieth, so
// that the cost of the solves stays proportional to the drive, and their number at the end bounds
// its time.
constexpr double kClosureEvery_m = 2.0;
constexpr double kOperationsPerMetre = 5e5;
constexpr int kNumAnchors = 3;
constexpr double kTryGrowth = 0.02;
constexpr int kSolvesAtEndMax = 6;

// derived: observations three standard deviations off on average undo a closure; the search radius
// is four of the pose plus a margin; places are thinned to a fifth of the sight range.
constexpr double kRefutedDistance2 = 9.0;
constexpr double kSearchSigmas = 4.0;
constexpr double kSearchMargin_m = 1.0;
constexpr double kPlaceCell_ranges = 0.2;

ClosureLandmark closure_landmark(const SlamGraph& graph, int landmark) {
  const SlamLandmark& l = graph.landmarks[landmark];
  return {landmark, l.p_map, l.width_m, l.width_sd_m(), l.seen_m};
}

/// Returns the positions from which landmarks were observed, one per cell of the ground.
std::vector<Eigen::Vector2d> places_of(const std::vector<int>& landmarks, const SlamGraph& graph,
                                       double cell_m) {
  std::set<std::pair<int, int>> known;
  std::vector<char> is_done(graph.keyframes.size(), 0);
  std::vector<Eigen::Vector2d> places;
  for (const int l : landmarks) {
    for (const int k : graph.landmarks[l].keyframes) {
      if (std::exchange(is_done[k], 1)) continue;
      const Eigen::Vector2d p = graph.keyframes[k].T_map_base.head<2>();
      const auto cell = [&](double x_m) { return static_cast<int>(std::floor(x_m / cell_m)); };
      if (known.emplace(cell(p.x()), cell(p.y())).second) places.push_back(p);
    }
  }
  return places;
}

/// Returns the mean squared Mahalanobis distance of a landmark's observations; call after a solve.
double mean_distance2(int landmark, const SlamGraph& graph) {
  const SlamLandmark& l = graph.landmarks[landmark];
  double sum = 0.0;
  int n = 0;
  for (const int k : l.keyframes) {
    const Keyframe& keyframe = graph.keyframes[k];
    for (const SlamObservation& o : keyframe.observations) {
      if (o.landmark != landmark) continue;
      const Eigen::Vector2d error = inverse_transform(keyframe.T_map_base, l.p_map) - o.position();
      sum += error.dot(o.covariance().inverse() * error);
      ++n;
    }
  }
  return n > 0 ? sum / (graph.observation_noise * n) : std::numeric_limits<double>::infinity();
}

/// Inlier check after the solve: true if the observations of the merged landmarks fit on average.
bool is_supported(const std::vector<std::pair<int, int>>& merged, const SlamGraph& graph) {
  double sum = 0.0;
  std::size_t n = 0;
  for (const auto& pair : merged) {
    const std::size_t num = graph.landmarks[pair.second].keyframes.size();
    if (num > 0) sum += static_cast<double>(num) * mean_distance2(pair.second, graph);
    n += num;
  }
  return n > 0 && sum <= kRefutedDistance2 * static_cast<double>(n);
}

}  // namespace

double lattice_residual_sd_m(const std::vector<Eigen::Vector2d>& trees) {
  return residual_sd_m(geometry::IndexedPoints(trees));
}

Closure find_closure(const ClosureQuery& query, const SlamConfig& config) {
  Closure closure;
  if (query.recent.size() < kClosureTreesMin || query.old.size() < kClosureTreesMin) return closure;
  ClosureMatcher matcher(query, config);
  if (!matcher.has_lattice()) return closure;
  std::vector<ClosureHypothesis> hypotheses = matcher.hypotheses();
  const auto better = [](const ClosureHypothesis& a, const ClosureHypothesis& b) {
    return a.score > b.score;
  };
  if (matcher.is_beyond_budget()) {
    closure.num_operations = matcher.num_operations();
    closure.ambiguous = true;
    return closure;
  }
  int num_votes_unscored = 0;
  if (hypotheses.size() > kNumScored) {
    std::stable_sort(hypotheses.begin(), hypotheses.end(),
                     [](const ClosureHypothesis& a, const ClosureHypothesis& b) {
                       return a.num_votes > b.num_votes;
                     });
    num_votes_unscored = hypotheses[kNumScored].num_votes;
    hypotheses.resize(kNumScored);
  }
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
      num_votes_unscored >= best.num_votes ||
      std::any_of(hypotheses.begin() + 1, hypotheses.end(), [&](const ClosureHypothesis& other) {
        return other.score > best.score - config.closure_margin && matcher.differ(other, best);
      });
  closure.found = !closure.ambiguous && best.score >= config.closure_margin;
  return closure;
}

/// Returns none while enough older landmarks are tracked, or if there are none to register to.
std::optional<ClosureQuery> LoopCloser::query(const SlamMap& map) const {
  const SlamGraph& graph = map.graph;
  const Keyframe& now = graph.keyframes.back();
  const double path_m = kClosureSubmap_ranges * map.detection_range_m();
  const auto ago_m = [&](int k) { return now.travel_m - graph.keyframes[k].travel_m; };
  ClosureQuery query;
  query.pivot = now.T_map_base.head<2>();
  query.covariance = now.covariance;
  int num_anchors = 0;
  for (const int l : map.local) {
    const SlamLandmark& landmark = graph.landmarks[l];
    if (landmark.keyframes.size() < 2 || !landmark.confirmed) continue;
    const int last = landmark.keyframes.back();
    if (ago_m(last) > path_m || last < map.session_start) continue;
    if (ago_m(landmark.keyframes.front()) > 2.0 * path_m) {
      num_anchors += ago_m(last) <= kTrackedTravel_ranges * map.detection_range_m() ? 1 : 0;
    } else {
      query.recent.push_back(closure_landmark(graph, l));
    }
  }
  if (num_anchors >= kNumAnchors || query.recent.size() < kClosureTreesMin) return std::nullopt;
  const Eigen::Matrix3d& P = now.covariance;
  const double radius_m = kSearchSigmas * std::sqrt(std::max(P(0, 0), P(1, 1))) + kSearchMargin_m +
                          kSearchSigmas * std::sqrt(P(2, 2)) * path_m;
  std::vector<char> is_near(graph.landmarks.size(), 0);
  for (const ClosureLandmark& r : query.recent) {
    for (const int l : map.index.near(r.p_map, radius_m)) is_near[l] = 1;
  }
  std::vector<int> old;
  for (int l = 0; l < static_cast<int>(is_near.size()); ++l) {
    const SlamLandmark& landmark = graph.landmarks[l];
    if (!is_near[l] || !landmark.confirmed || landmark.keyframes.empty()) continue;
    const int last = landmark.keyframes.back();
    if (ago_m(last) > path_m || last < map.session_start) old.push_back(l);
  }
  if (old.size() < kClosureTreesMin) return std::nullopt;
  for (const int l : old) query.old.push_back(closure_landmark(graph, l));
  for (int k = map.newest(); k >= map.session_start && ago_m(k) <= path_m; --k) {
    query.path.push_back(graph.keyframes[k].T_map_base.head<2>());
  }
  query.old_path = places_of(old, graph, kPlaceCell_ranges * map.detection_range_m());
  return query;
}

void LoopCloser::observe(SlamMap& map) {
  const double travel_m = map.graph.keyframes.back().travel_m;
  const double every_m =
      std::max(kClosureEvery_m, static_cast<double>(last_operations_) / kOperationsPerMetre);
  if (travel_m - last_travel_m_ < every_m ||
      static_cast<double>(map.graph.keyframes.size()) < num_keyframes_ * (1.0 + kTryGrowth)) {
    return;
  }
  last_travel_m_ = travel_m;
  close(map);
}

void LoopCloser::close(SlamMap& map) {
  ambiguous_ = false;
  last_operations_ = 0;
  const std::optional<ClosureQuery> query = this->query(map);
  if (!query) return;
  ++counts_.num_searches;
  const Closure closure = find_closure(*query, config_);
  counts_.num_operations += closure.num_operations;
  last_operations_ = closure.num_operations;
  ambiguous_ = closure.ambiguous;
  if (!closure.found) return;
  for (const auto& [recent, old] : closure.matches) {
    if (map.graph.co_observed(recent, old)) return;
  }
  num_keyframes_ = static_cast<int>(map.graph.keyframes.size());
  SlamUndo undo(map);
  for (const auto& [recent, old] : closure.matches) map.graph.merge(recent, old);
  const auto fits = [&](const SlamGraph& graph) { return is_supported(closure.matches, graph); };
  if (map.solve(SolveReason::kLoopClosure, fits)) {
    map.session_start = 0;
    map.lost = false;
    ++counts_.num_closures;
    return;
  }
  undo.restore();
  ++counts_.num_refuted;
}

void LoopCloser::merge_duplicate_landmarks(SlamMap& map) {
  for (int i = 0; i < kSolvesAtEndMax && map.num_merged > 0; ++i) {
    if (!map.solve(SolveReason::kDuplicatesAtEnd)) return;
  }
}

}  // namespace orchard::pose
