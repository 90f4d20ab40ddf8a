// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/gnss_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

constexpr std::size_t kSightsLeast = 10;
constexpr double kSpreadLeast_m = 5.0;
constexpr double kSpreadScatter = 20.0;
constexpr double kOutlierMedians = 4.0;
constexpr int kRounds = 30;

struct Fit {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();
  double spread_m = 0.0;  ///< root mean square distance of the points from their centre
};

Eigen::Vector2d laid(const Eigen::Vector3d& x_y_yaw, const Eigen::Vector2d& p) {
  const double c = std::cos(x_y_yaw.z()), s = std::sin(x_y_yaw.z());
  return {c * p.x() - s * p.y() + x_y_yaw.x(), s * p.x() + c * p.y() + x_y_yaw.y()};
}

Fit fit(const std::vector<AntennaSight>& sights, const std::vector<double>& trusts) {
  double total = 0.0;
  Eigen::Vector2d map_m = Eigen::Vector2d::Zero(), enu_m = Eigen::Vector2d::Zero();
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const double weight = trusts[i] / sights[i].variance_m2;
    total += weight;
    map_m += weight * sights[i].p_map_m;
    enu_m += weight * sights[i].p_enu_m;
  }
  map_m /= total;
  enu_m /= total;
  double dot = 0.0, cross = 0.0, spread2 = 0.0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const double weight = trusts[i] / sights[i].variance_m2 / total;
    const Eigen::Vector2d a = sights[i].p_map_m - map_m, b = sights[i].p_enu_m - enu_m;
    dot += weight * a.dot(b);
    cross += weight * (a.x() * b.y() - a.y() * b.x());
    spread2 += weight * a.squaredNorm();
  }
  Fit result;
  result.x_y_yaw.z() = std::atan2(cross, dot);
  result.x_y_yaw.head<2>() = enu_m - laid({0.0, 0.0, result.x_y_yaw.z()}, map_m);
  result.spread_m = std::sqrt(spread2);
  return result;
}

}  // namespace

std::optional<GnssAlignment> align_to_gnss(const std::vector<AntennaSight>& sights) {
  if (sights.size() < kSightsLeast) return std::nullopt;
  std::vector<double> trusts(sights.size(), 1.0);
  std::vector<double> off_m(sights.size());
  Fit best;
  double median_m = 0.0;
  const auto look = [&] {
    best = fit(sights, trusts);
    for (std::size_t i = 0; i < sights.size(); ++i) {
      off_m[i] = (sights[i].p_enu_m - laid(best.x_y_yaw, sights[i].p_map_m)).norm();
    }
    median_m = geometry::median(off_m);
  };
  // Geman and McClure's weights at the scale of the median, which shrinks as outliers lose theirs.
  for (int round = 0; round < kRounds; ++round) {
    look();
    for (std::size_t i = 0; i < sights.size(); ++i) {
      const double scale2 = std::max(median_m * median_m, sights[i].variance_m2);
      const double trust = scale2 / (scale2 + off_m[i] * off_m[i]);
      trusts[i] = trust * trust;
    }
  }
  std::vector<char> is_used(sights.size());
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const double most_m =
        std::max(kOutlierMedians * median_m, 3.0 * std::sqrt(sights[i].variance_m2));
    is_used[i] = off_m[i] <= most_m ? 1 : 0;
    trusts[i] = is_used[i];
  }
  look();
  GnssAlignment alignment;
  double sum2 = 0.0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    if (is_used[i] == 0) {
      ++alignment.num_left_out;
      continue;
    }
    ++alignment.num_used;
    sum2 += off_m[i] * off_m[i];
  }
  if (alignment.num_used < static_cast<int>(kSightsLeast)) return std::nullopt;
  alignment.x_y_yaw = best.x_y_yaw;
  alignment.residual_rms_m = std::sqrt(sum2 / alignment.num_used);
  const double spread_wanted_m = std::max(
      kSpreadLeast_m, kSpreadScatter * alignment.residual_rms_m / std::sqrt(alignment.num_used));
  if (best.spread_m < spread_wanted_m) return std::nullopt;
  return alignment;
}

}  // namespace orchard::pose
