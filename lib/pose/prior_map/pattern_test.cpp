// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/pattern_test.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

using geometry::square;

// derived: neighbours in a square of five by five without its corners; half of them are enough, and
// one with half the landmarks in view is leaving the map. After a pass of the trunks the rivals
// have been corrected by as many as the place.
constexpr std::size_t kRivals = 20;
constexpr double kLeaving = 0.5;
constexpr double kSettledPasses = 1.0;

}  // namespace

PatternTest::PatternTest(const PriorMap& map, const PlaceLikelihood& likelihood)
    : map_(map), likelihood_(likelihood) {}

void PatternTest::clear() {
  rivals_.clear();
  log_evidence_ = 0.0;
}

void PatternTest::move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance) {
  for (WeighedPlace& rival : rivals_) rival.move(T_base_next, covariance);
}

void PatternTest::choose_rivals(const WeighedPlace& place, double range_m) {
  rivals_.clear();
  passes_ = 0.0;
  const Eigen::Vector2d base = place.T_map_base.head<2>();
  std::int32_t nearest = -1;
  double nearest_m = std::numeric_limits<double>::max();
  std::vector<std::pair<double, std::int32_t>> around;
  map_.near(base, 2.0 * range_m, [&](std::int32_t i) {
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
    if (is_same(place) || std::any_of(rivals_.begin(), rivals_.end(), is_same)) continue;
    rivals_.push_back(rival);
  }
}

void PatternTest::add(const WeighedPlace& place, const PlaceLikelihood::ScanView& scan,
                      double share) {
  if (rivals_.size() < kRivals / 2) choose_rivals(place, scan.range_m());
  WeighedPlace corrected = place;
  const double log_likelihood = likelihood_.correct(corrected, scan, share);
  std::vector<double> logs{log_likelihood};
  for (WeighedPlace& rival : rivals_) logs.push_back(likelihood_.correct(rival, scan, share));
  const double most = *std::max_element(logs.begin(), logs.end());
  double sum = 0.0;
  for (const double log : logs) sum += std::exp(log - most);
  passes_ += share;
  if (passes_ > kSettledPasses && rivals_.size() >= kRivals / 2) {
    log_evidence_ +=
        share * (log_likelihood - most - std::log(sum / static_cast<double>(logs.size())));
    log_evidence_ = std::min(log_evidence_, kLogEvidenceMax);
  }
  const auto is_none = [&](const WeighedPlace& rival) {
    return rival.expected < kLeaving * corrected.expected ||
           likelihood_.are_near(rival.T_map_base, corrected.T_map_base);
  };
  rivals_.erase(std::remove_if(rivals_.begin(), rivals_.end(), is_none), rivals_.end());
}

}  // namespace orchard::pose
