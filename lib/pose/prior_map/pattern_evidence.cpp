// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/pattern_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

using geometry::square;

// derived: neighbours in a square of five by five without its corners; half of them are enough, and
// one with half the landmarks in view, or with half of what is seen beside the map, is leaving it.
// A place a range beside the map has rivals a range within it by landmarks that are three ranges
// away. After a pass of the trunks the rivals have been corrected by as many as the place.
constexpr std::size_t kRivals = 20;
constexpr double kLeaving = 0.5;
constexpr double kSettledPasses = 1.0;
constexpr double kAround_ranges = 3.0;

/// The logarithm of the mean of these likelihoods.
double log_mean(const std::vector<double>& logs) {
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double log : logs) sum += std::exp(log - most);
  return most + std::log(sum / static_cast<double>(logs.size()));
}

}  // namespace

PatternEvidence::PatternEvidence(const PriorMap& map, const PlaceLikelihood& likelihood)
    : map_(map), likelihood_(likelihood) {}

void PatternEvidence::clear() {
  rivals_.clear();
  log_evidence_ = 0.0;
}

void PatternEvidence::move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance) {
  for (WeighedPlace& rival : rivals_) rival.move(T_base_next, covariance);
}

void PatternEvidence::choose_rivals(const WeighedPlace& place, double range_m) {
  rivals_.clear();
  passes_ = 0.0;
  const Eigen::Vector2d base = place.T_map_base.head<2>();
  std::int32_t nearest = -1;
  double nearest_m = std::numeric_limits<double>::max();
  std::vector<std::pair<double, std::int32_t>> around;
  map_.near(base, kAround_ranges * range_m, [&](std::int32_t i) {
    const double distance_m = (map_[i].p_map - base).norm();
    if (distance_m < nearest_m) nearest = i, nearest_m = distance_m;
    around.emplace_back(distance_m, i);
  });
  for (auto& [distance_m, i] : around) {
    distance_m = (map_[i].p_map - map_[nearest].p_map).norm();
  }
  std::sort(around.begin(), around.end());
  for (const auto& [distance_m, i] : around) {
    if (rivals_.size() >= kRivals) return;
    WeighedPlace rival = place;
    rival.T_map_base.head<2>() += map_[i].p_map - map_[nearest].p_map;
    rival.covariance.topLeftCorner<2, 2>() +=
        square(0.5 * likelihood_.place_sd_m()) * Eigen::Matrix2d::Identity();
    const auto is_same = [&](const WeighedPlace& other) {
      return likelihood_.are_near(other.T_map_base, rival.T_map_base);
    };
    if (!map_.was_seen(rival.T_map_base.head<2>()) || is_same(place) ||
        std::any_of(rivals_.begin(), rivals_.end(), is_same))
      continue;
    rivals_.push_back(rival);
  }
}

void PatternEvidence::add(const WeighedPlace& place, PlaceLikelihood::ScanView& scan,
                          double share) {
  if (rivals_.size() < kRivals / 2) choose_rivals(place, scan.range_m());
  std::vector<double> logs;
  for (WeighedPlace& rival : rivals_) {
    const double log = likelihood_.correct(rival, scan, share);
    logs.push_back(log / std::max(kLeaving, rival.known));
  }
  const double num_targets = std::max<double>(1.0, scan.targets().size());
  if (!logs.empty()) scan.set_log_unknown(log_mean(logs) / num_targets);
  WeighedPlace corrected = place;
  const double log_likelihood = likelihood_.correct(corrected, scan, share);
  logs.push_back(log_likelihood);
  passes_ += share;
  if (passes_ > kSettledPasses && rivals_.size() >= kRivals / 2) {
    log_evidence_ += share * (log_likelihood - log_mean(logs));
    log_evidence_ = std::min(log_evidence_, kLogEvidenceMax);
  }
  const auto is_none = [&](const WeighedPlace& rival) {
    return rival.expected < kLeaving * corrected.expected || rival.known < kLeaving ||
           likelihood_.are_near(rival.T_map_base, corrected.T_map_base);
  };
  rivals_.erase(std::remove_if(rivals_.begin(), rivals_.end(), is_none), rivals_.end());
}

}  // namespace orchard::pose
