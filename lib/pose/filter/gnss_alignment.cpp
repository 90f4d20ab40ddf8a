// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/gnss_alignment.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/rigid_fit2.hpp"
#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

constexpr std::size_t kObservationsMin = 10;
constexpr double kSpreadMin_m = 5.0;
constexpr double kSpreadScatter = 20.0;
constexpr double kOutlierMedians = 4.0;
constexpr int kRounds = 30;

geometry::RigidFit2 fit(const std::vector<AntennaObservation>& observations,
                        const std::vector<double>& trusts) {
  std::vector<Eigen::Vector2d> p_enu_m, p_map_m;
  std::vector<double> weights;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    p_enu_m.push_back(observations[i].p_enu_m);
    p_map_m.push_back(observations[i].p_map_m);
    weights.push_back(trusts[i] / observations[i].variance_m2);
  }
  return geometry::fit_rigid(p_enu_m, p_map_m, weights);
}

}  // namespace

std::optional<GnssAlignment> align_to_gnss(const std::vector<AntennaObservation>& observations) {
  if (observations.size() < kObservationsMin) return std::nullopt;
  std::vector<double> trusts(observations.size(), 1.0);
  std::vector<double> off_m(observations.size());
  geometry::RigidFit2 best;
  double median_m = 0.0;
  const auto observe = [&] {
    best = fit(observations, trusts);
    for (std::size_t i = 0; i < observations.size(); ++i) {
      off_m[i] = (observations[i].p_enu_m - transform(best.T_a_b, observations[i].p_map_m)).norm();
    }
    median_m = geometry::median(off_m);
  };
  // Geman-McClure weights, scaled by the median residual, which shrinks as outliers lose weight.
  for (int round = 0; round < kRounds; ++round) {
    observe();
    for (std::size_t i = 0; i < observations.size(); ++i) {
      const double scale2 = std::max(median_m * median_m, observations[i].variance_m2);
      const double trust = scale2 / (scale2 + off_m[i] * off_m[i]);
      trusts[i] = trust * trust;
    }
  }
  std::vector<char> is_used(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const double most_m =
        std::max(kOutlierMedians * median_m, 3.0 * std::sqrt(observations[i].variance_m2));
    is_used[i] = off_m[i] <= most_m ? 1 : 0;
    trusts[i] = is_used[i];
  }
  observe();
  GnssAlignment alignment;
  double sum2 = 0.0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (is_used[i] == 0) {
      ++alignment.num_left_out;
      continue;
    }
    ++alignment.num_used;
    sum2 += off_m[i] * off_m[i];
  }
  if (alignment.num_used < static_cast<int>(kObservationsMin)) return std::nullopt;
  alignment.x_y_yaw = best.T_a_b.vector();
  alignment.residual_rms_m = std::sqrt(sum2 / alignment.num_used);
  const double spread_wanted_m = std::max(
      kSpreadMin_m, kSpreadScatter * alignment.residual_rms_m / std::sqrt(alignment.num_used));
  if (std::sqrt(best.mean_square_b_m2) < spread_wanted_m) return std::nullopt;
  return alignment;
}

}  // namespace orchard::pose
