// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/prior_map.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <limits>
#include <tuple>

#include "geometry/statistics.hpp"
#include "pose/repeat_model.hpp"

namespace orchard::pose {
namespace {

// physical: limits of plausible orchards in metres, which maps in mm, cm or km exceed; two trunks
// do not stand nearer than kOneTrunkM.
constexpr std::size_t kMinLandmarks = 3;
constexpr double kMaxCoordinateM = 1e8;
constexpr double kOneTrunkM = 0.4;
constexpr double kMaxTrunkM = 3.0;
constexpr double kMaxSpacingM = 50.0;
constexpr double kMinSpacingM = 0.05;

// derived: the min detection rate of a trunk in LocalTrunkMap (its kSureFraction); a bound on the
// cost of a dense map.
constexpr double kSeenMostly = 0.5;
constexpr std::size_t kMaxNeighbours = 60;

/// Returns the median distance to the nearest other landmark, by a sweep over x.
double median_spacing_m(const std::vector<PriorLandmark>& landmarks) {
  std::vector<Eigen::Vector2d> points;
  for (const PriorLandmark& l : landmarks) points.push_back(l.p_map);
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return std::make_pair(a.x(), a.y()) < std::make_pair(b.x(), b.y());
  });
  std::vector<double> nearest_m(points.size(), std::numeric_limits<double>::max());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const double dx_m = points[j].x() - points[i].x();
      if (dx_m > nearest_m[i]) break;
      const double distance_m = (points[j] - points[i]).norm();
      nearest_m[i] = std::min(nearest_m[i], distance_m);
      nearest_m[j] = std::min(nearest_m[j], distance_m);
    }
  }
  return geometry::median(std::move(nearest_m));
}

std::string rounded(double value) { return fmt::format("{:.3g}", value); }

}  // namespace

std::string problem_with(const std::vector<PriorLandmark>& landmarks) {
  if (landmarks.empty())
    return "has no landmark with at least pose.prior_map.min_observations observations";
  if (landmarks.size() < kMinLandmarks) {
    return "has only " + std::to_string(landmarks.size()) +
           " landmarks; localisation needs at least " + std::to_string(kMinLandmarks);
  }
  std::vector<double> widths_m;
  for (const PriorLandmark& l : landmarks) {
    const bool sound = std::abs(l.p_map.x()) <= kMaxCoordinateM &&
                       std::abs(l.p_map.y()) <= kMaxCoordinateM && std::isfinite(l.width_m);
    if (!sound) return "has a landmark with an invalid position or width";
    if (l.width_m > 0.0) widths_m.push_back(l.width_m);
  }
  const double width_m = geometry::median(std::move(widths_m));
  if (width_m > kMaxTrunkM) {
    return "is not in metres: half of its landmarks are " + rounded(width_m) + " m wide or more";
  }
  const double spacing_m = median_spacing_m(landmarks);
  if (spacing_m > kMaxSpacingM || spacing_m < kMinSpacingM) {
    return "is not in metres: its landmarks are " + rounded(spacing_m) +
           " m apart (median), but trees are " + rounded(kMinSpacingM) + " to " +
           rounded(kMaxSpacingM) + " m apart";
  }
  return {};
}

std::vector<PriorLandmark> without_duplicates(const std::vector<PriorLandmark>& landmarks) {
  std::vector<PriorLandmark> heaviest_first = landmarks;
  std::stable_sort(heaviest_first.begin(), heaviest_first.end(),
                   [](const auto& a, const auto& b) { return a.weight > b.weight; });
  const PriorMap map(heaviest_first, 0.0);
  std::vector<std::int32_t> kept(heaviest_first.size(), -1);  // index in `merged`, -1: none
  std::vector<PriorLandmark> merged;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(heaviest_first.size()); ++i) {
    const PriorLandmark& landmark = map[i];
    std::int32_t into = -1;
    map.near(landmark.p_map, kOneTrunkM, [&](std::int32_t j) {
      const bool double_of =
          j < i && kept[j] >= 0 && (map[j].p_map - landmark.p_map).norm() < kOneTrunkM;
      if (double_of && (into < 0 || j < into)) into = j;
    });
    if (into < 0) {
      kept[i] = static_cast<std::int32_t>(merged.size());
      merged.push_back(landmark);
      continue;
    }
    PriorLandmark& one = merged[static_cast<std::size_t>(kept[into])];
    const double fraction = landmark.weight / std::max(1e-9, one.weight + landmark.weight);
    one.p_map += fraction * (landmark.p_map - one.p_map);
    if (one.width_m > 0.0 && landmark.width_m > 0.0) {
      one.width_m += fraction * (landmark.width_m - one.width_m);
    }
    one.weight += landmark.weight;
    one.sd_m = std::max(one.sd_m, landmark.sd_m);
    one.rate = std::max(one.rate, landmark.rate);
  }
  return merged;
}

PriorMap::PriorMap(PriorMapData earlier, double pair_max_m)
    : landmarks_(std::move(earlier.landmarks)),
      is_seen_known_(!earlier.seen_m.empty()),
      seen_(earlier.cell_m) {
  // The grid visits a cell's points in reverse order of insertion, hence in ascending order here.
  for (auto i = static_cast<std::int32_t>(landmarks_.size()) - 1; i >= 0; --i) {
    grid_.insert(i, (*this)[i].p_map);
  }

  for (std::int32_t i = 0; i < static_cast<std::int32_t>(landmarks_.size()); ++i) {
    std::vector<Pair> mine;
    near((*this)[i].p_map, pair_max_m, [&](std::int32_t j) {
      const double distance_m = ((*this)[j].p_map - (*this)[i].p_map).norm();
      if (j > i && distance_m <= pair_max_m) mine.push_back({static_cast<float>(distance_m), i, j});
    });
    std::sort(mine.begin(), mine.end(), [](const Pair& a, const Pair& b) {
      return std::tie(a.distance_m, a.second) < std::tie(b.distance_m, b.second);
    });
    mine.resize(std::min(mine.size(), kMaxNeighbours));
    pairs_.insert(pairs_.end(), mine.begin(), mine.end());
  }
  std::sort(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.distance_m, a.first, a.second) < std::tie(b.distance_m, b.first, b.second);
  });

  double sum_m = 0.0, sum_m2 = 0.0;
  int num_widths = 0;
  for (const PriorLandmark& l : landmarks_) {
    if (l.width_m <= 0.0) continue;
    sum_m += l.width_m;
    sum_m2 += l.width_m * l.width_m;
    ++num_widths;
  }
  if (num_widths > 1) {
    const double mean_m = sum_m / num_widths;
    width_sd_m_ = std::sqrt(std::max(0.0, sum_m2 / num_widths - mean_m * mean_m));
  }
  if (landmarks_.size() > 1) spacing_m_ = median_spacing_m(landmarks_);

  for (std::int32_t i = 0; i < static_cast<std::int32_t>(landmarks_.size()); ++i) {
    int num_others = 0;
    near((*this)[i].p_map, clump_reach_m(), [&](std::int32_t j) {
      num_others += j != i && ((*this)[j].p_map - (*this)[i].p_map).norm() < clump_reach_m();
    });
    repeat_.push_back((1.0 - kChangeFraction) * probability_same_part(num_others) *
                      probability_seen_again((*this)[i].rate, kSeenMostly));
  }
  for (const Eigen::Vector2d& p : earlier.seen_m) seen_.insert(0, p);
}

bool PriorMap::was_seen(const Eigen::Vector2d& p_map) const {
  bool is_seen = !is_seen_known_;
  seen_.near(p_map.x(), p_map.y(), 0.0, [&](std::int32_t) { is_seen = true; });
  return is_seen;
}

double PriorMap::clump_reach_m() const { return pose::clump_reach_m(spacing_m_); }

std::pair<std::size_t, std::size_t> PriorMap::pairs_at(double least_m, double most_m) const {
  const auto below = [](const Pair& pair, double distance_m) {
    return pair.distance_m < distance_m;
  };
  const auto begin = std::lower_bound(pairs_.begin(), pairs_.end(), least_m, below);
  const auto end = std::lower_bound(begin, pairs_.end(), most_m, below);
  return {static_cast<std::size_t>(begin - pairs_.begin()),
          static_cast<std::size_t>(end - pairs_.begin())};
}

}  // namespace orchard::pose
