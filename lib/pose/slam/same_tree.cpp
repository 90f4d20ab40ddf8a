// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/same_tree.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "pose/graph/solver.hpp"
#include "pose/graph/submaps.hpp"

namespace orchard::pose {
namespace {

// derived: one false pair in a hundred searches; trees that look like two lie within their distance
// plus three standard deviations; the spacing of trees is the first decile of the distances between
// neighbours observed together.
constexpr double kFalsePairsMax = 0.01;
constexpr double kReach_sigma = 3.0;
constexpr int kNearestOfTen = 1;

bool is_tree(const SlamLandmark& landmark) { return landmark.alive && landmark.confirmed; }

double apart_m(const SlamLandmark& a, const SlamLandmark& b) { return (b.p_map - a.p_map).norm(); }

/// Returns the spacing of trees: a low quantile of the distances from each landmark to the nearest
/// one that was observed by the same keyframe [m]; 0 if there are too few.
double spacing_m(const SlamGraph& graph, const geometry::PointGrid& index, double reach_m) {
  std::vector<double> nearest_m;
  for (int l = 0; l < static_cast<int>(graph.landmarks.size()); ++l) {
    if (!is_tree(graph.landmarks[l])) continue;
    double best_m = std::numeric_limits<double>::infinity();
    for (const int other : index.near(graph.landmarks[l].p_map, reach_m)) {
      if (other == l || !is_tree(graph.landmarks[other])) continue;
      const double distance_m = apart_m(graph.landmarks[l], graph.landmarks[other]);
      if (distance_m < best_m && graph.co_observed(l, other)) best_m = distance_m;
    }
    if (std::isfinite(best_m)) nearest_m.push_back(best_m);
  }
  if (nearest_m.size() < 10) return 0.0;
  const auto at =
      nearest_m.begin() + static_cast<std::ptrdiff_t>(nearest_m.size()) * kNearestOfTen / 10;
  std::nth_element(nearest_m.begin(), at, nearest_m.end());
  return *at;
}

/// True if `nearer`, at nearer_base, occludes the point p_base seen from base.
bool covers(const SlamLandmark& nearer, const Eigen::Vector2d& nearer_base,
            const Eigen::Vector2d& p_base) {
  const double apart_rad = geometry::wrap_angle_rad(std::atan2(nearer_base.y(), nearer_base.x()) -
                                                    std::atan2(p_base.y(), p_base.x()));
  return nearer_base.norm() < p_base.norm() &&
         std::abs(apart_rad) < 0.5 * nearer.width_m / nearer_base.norm();
}

/// The systematic error of a trunk's position, per axis. A trunk is not round: the side that was
/// observed tells only that the centre lies within it. The standard deviation of a uniform disc is
/// half its radius.
double trunk_variance_m2(const SlamLandmark& landmark, const SlamConfig& config) {
  const double shape_m = 0.25 * landmark.width_m;
  return config.closure_sd_m * config.closure_sd_m + shape_m * shape_m;
}

Eigen::Matrix2d distance_covariance(const SlamLandmark& a, const SlamLandmark& b,
                                    const Eigen::Matrix2d& relative_m2, const SlamConfig& config) {
  return relative_m2 + (trunk_variance_m2(a, config) + trunk_variance_m2(b, config)) *
                           Eigen::Matrix2d::Identity();
}

double reach_of_m(const SlamLandmark& a, const SlamLandmark& b, const Eigen::Matrix2d& S) {
  return apart_m(a, b) + kReach_sigma * std::sqrt(S.trace());
}

double normal_density(double x, double sd) {
  return std::exp(-0.5 * x * x / (sd * sd)) / (std::sqrt(2.0 * geometry::kPi) * sd);
}

struct Candidates {
  std::vector<std::pair<int, int>> overlapping;  ///< observed together: a scan knows their distance
  std::vector<std::pair<int, int>> never_together;
};

Candidates candidates(const SlamGraph& graph, const geometry::PointGrid& index, double near_m) {
  Candidates pairs;
  for (int l = 0; l < static_cast<int>(graph.landmarks.size()); ++l) {
    const SlamLandmark& a = graph.landmarks[l];
    if (!is_tree(a)) continue;
    for (const int other : index.near(a.p_map, near_m)) {
      const SlamLandmark& b = graph.landmarks[other];
      if (other <= l || !is_tree(b) || apart_m(a, b) > near_m) continue;
      if (!graph.co_observed(l, other)) {
        pairs.never_together.emplace_back(l, other);
      } else if (trunks_overlap(a, b)) {
        pairs.overlapping.emplace_back(l, other);
      }
    }
  }
  return pairs;
}

}  // namespace

bool trunks_overlap(const SlamLandmark& a, const SlamLandmark& b) {
  return apart_m(a, b) < 0.5 * (a.width_m + b.width_m);
}

TreeStatistics::TreeStatistics(const SlamGraph& graph, const geometry::PointGrid& index,
                               double reach_m)
    : reach_m_(reach_m) {
  for (int l = 0; l < static_cast<int>(graph.landmarks.size()); ++l) {
    const SlamLandmark& a = graph.landmarks[l];
    if (!is_tree(a)) continue;
    widths_m_.push_back(a.width_m);
    for (const int other : index.near(a.p_map, reach_m)) {
      const SlamLandmark& b = graph.landmarks[other];
      if (other <= l || !is_tree(b) || apart_m(a, b) > reach_m || trunks_overlap(a, b)) continue;
      if (graph.co_observed(l, other)) apart_m_.push_back(apart_m(a, b));
    }
  }
  std::sort(apart_m_.begin(), apart_m_.end());
}

int TreeStatistics::num_pairs(double radius_m) const {
  return static_cast<int>(std::upper_bound(apart_m_.begin(), apart_m_.end(), radius_m) -
                          apart_m_.begin());
}

double TreeStatistics::density_per_m2(double radius_m) const {
  const double r_m = std::min(radius_m, reach_m_);
  // One more than were observed: that a small map shows none does not say that there are none.
  return (2.0 * num_pairs(r_m) + 1.0) /
         (static_cast<double>(widths_m_.size()) * geometry::kPi * r_m * r_m);
}

double TreeStatistics::width_density_per_m(double width_m, double sd_m) const {
  double sum = 0.0;
  for (const double w_m : widths_m_) sum += normal_density(width_m - w_m, sd_m);
  return sum / static_cast<double>(widths_m_.size());
}

double same_tree_log_ratio(const SlamLandmark& a, const SlamLandmark& b,
                           const Eigen::Matrix2d& relative_m2, const TreeStatistics& trees,
                           const SlamConfig& config) {
  const Eigen::Matrix2d S = distance_covariance(a, b, relative_m2, config);
  const Eigen::Vector2d offset_m = b.p_map - a.p_map;
  const double position = -0.5 * offset_m.dot(S.inverse() * offset_m) -
                          std::log(2.0 * geometry::kPi * std::sqrt(S.determinant())) -
                          std::log(trees.density_per_m2(reach_of_m(a, b, S)));
  const double width_sd_m = std::hypot(std::hypot(a.width_sd_m(), b.width_sd_m()),
                                       config.width_gate_m / config.gate_sigma);
  const double width = -0.5 * std::pow((b.width_m - a.width_m) / width_sd_m, 2) -
                       std::log(std::sqrt(2.0 * geometry::kPi) * width_sd_m) -
                       std::log(trees.width_density_per_m(b.width_m, width_sd_m));
  return position + width;
}

double missed_log_ratio(const SlamGraph& graph, const geometry::PointGrid& index,
                        const SensorCoverage& coverage, int seen, int missed) {
  std::map<int, int> num_in_view;  // per landmark: keyframes that should have observed it
  std::map<int, bool> observed;
  const SlamLandmark& a = graph.landmarks[seen];
  for (const int k : a.keyframes) {
    const Keyframe& keyframe = graph.keyframes[k];
    const Eigen::Vector2d a_base = geometry::inverse_transform(keyframe.T_map_base, a.p_map);
    const geometry::OcclusionTest occlusion = occlusion_by(keyframe, graph, seen);
    for (const SlamObservation& o : keyframe.observations) observed[o.landmark] = true;
    for (const int l : index.near(keyframe.T_map_base.head<2>(), coverage.range_max_m())) {
      if (l == seen || !is_tree(graph.landmarks[l]) || observed.count(l) != 0) continue;
      const Eigen::Vector2d p_base =
          geometry::inverse_transform(keyframe.T_map_base, graph.landmarks[l].p_map);
      num_in_view[l] +=
          coverage.in_view(p_base) && !covers(a, a_base, p_base) && !occlusion.occludes(p_base);
    }
  }
  if (observed.count(missed) != 0 || num_in_view[missed] < kConfirmKeyframes) return 0.0;
  double num_missed = 0.0;
  for (const auto& [l, num] : num_in_view) {
    num_missed += l != missed && observed.count(l) == 0 && num >= kConfirmKeyframes ? 1.0 : 0.0;
  }
  const double num_observed = static_cast<double>(observed.size()) - 1.0;  // without `seen`
  return std::log((num_observed + num_missed + 2.0) / (num_missed + 1.0));
}

std::vector<std::pair<int, int>> find_same_trees(const SlamGraph& graph,
                                                 const geometry::PointGrid& index,
                                                 const SensorCoverage& coverage,
                                                 const SlamConfig& config) {
  const double near_m =
      std::max(config.new_landmark_m, spacing_m(graph, index, coverage.range_max_m()));
  Candidates all = candidates(graph, index, near_m);
  std::vector<std::pair<int, int>> same = std::move(all.overlapping);
  const std::vector<std::pair<int, int>>& pairs = all.never_together;
  if (pairs.empty()) return same;
  const std::optional<std::vector<Eigen::Matrix2d>> relative_m2 =
      relative_covariances(submaps_of(graph, config).graph, pairs, config);
  if (!relative_m2) return same;
  std::vector<double> reaches_m;  // per pair; 0: too far apart for their uncertainty
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const SlamLandmark& a = graph.landmarks[pairs[i].first];
    const SlamLandmark& b = graph.landmarks[pairs[i].second];
    const Eigen::Matrix2d S = distance_covariance(a, b, (*relative_m2)[i], config);
    const Eigen::Vector2d offset_m = b.p_map - a.p_map;
    const bool is_near = offset_m.dot(S.inverse() * offset_m) < kReach_sigma * kReach_sigma;
    reaches_m.push_back(is_near ? std::min(reach_of_m(a, b, S), coverage.range_max_m()) : 0.0);
  }
  const TreeStatistics trees(graph, index, *std::max_element(reaches_m.begin(), reaches_m.end()));
  std::vector<std::tuple<double, int, int>> found;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (reaches_m[i] <= 0.0) continue;
    const auto& [l, other] = pairs[i];
    const SlamLandmark& a = graph.landmarks[l];
    const SlamLandmark& b = graph.landmarks[other];
    // The trees expected where the tree of `a` may be; each could be the tree of `b`.
    const double rivals =
        trees.density_per_m2(reaches_m[i]) * geometry::kPi * reaches_m[i] * reaches_m[i];
    const double min_ratio = std::log(std::max(1.0, rivals) / kFalsePairsMax);
    double ratio = same_tree_log_ratio(a, b, (*relative_m2)[i], trees, config);
    if (ratio <= min_ratio) {
      const bool b_is_less = b.keyframes.size() < a.keyframes.size();
      ratio +=
          missed_log_ratio(graph, index, coverage, b_is_less ? other : l, b_is_less ? l : other);
    }
    if (ratio > min_ratio) found.emplace_back(-ratio, l, other);
  }
  std::sort(found.begin(), found.end());
  for (const auto& [minus_ratio, l, other] : found) same.emplace_back(l, other);
  return same;
}

}  // namespace orchard::pose
