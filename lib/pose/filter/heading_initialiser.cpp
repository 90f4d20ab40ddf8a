// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/heading_initialiser.hpp"

#include <algorithm>

#include "geometry/rigid_fit2.hpp"

namespace orchard::pose {
namespace {

constexpr std::size_t kPairsMax = 200;
constexpr double kStartSpreadSigma = 6.0;

/// Max number of independent errors on this short path: a receiver's errors are time-correlated.
constexpr double kIndependentMax = 4.0;

}  // namespace

std::optional<LocalFrame> HeadingInitialiser::add(const Eigen::Vector2d& p_local_m,
                                                  const Eigen::Vector2d& p_map_m,
                                                  double variance_m2) {
  if (pairs_.size() == kPairsMax) pairs_.erase(pairs_.begin());
  pairs_.push_back({p_local_m, p_map_m, variance_m2});

  std::vector<Eigen::Vector2d> p_local_all_m, p_map_all_m;
  double variance = 0.0, reach2 = 0.0;
  const double n = static_cast<double>(pairs_.size());
  for (const Pair& p : pairs_) {
    p_local_all_m.push_back(p.p_local_m);
    p_map_all_m.push_back(p.p_map_m);
    variance += p.variance_m2 / n;
    reach2 = std::max(reach2, (p.p_local_m - pairs_.front().p_local_m).squaredNorm());
  }
  if (pairs_.size() < 3 || reach2 < baseline_m_ * baseline_m_) return std::nullopt;

  const geometry::RigidFit2 fit = geometry::fit_rigid(p_map_all_m, p_local_all_m);
  double misfit2 = 0.0;
  for (const Pair& p : pairs_) {
    misfit2 += (p.p_map_m - transform(fit.T_a_b, p.p_local_m)).squaredNorm() / (2.0 * n);
  }
  // Receivers often claim too small a variance: use the scatter of the residuals if it is larger.
  const double believed = std::max(variance, misfit2);
  if (reach2 < kStartSpreadSigma * kStartSpreadSigma * believed) {
    if (pairs_.size() == kPairsMax && misfit2 > variance) {
      // The oldest points contain a jump or drift: continue without them.
      pairs_.erase(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(kPairsMax / 2));
    }
    return std::nullopt;
  }
  LocalFrame frame;
  frame.x_y_yaw = fit.T_a_b.vector();
  frame.yaw_variance = believed / (std::min(n, kIndependentMax) * fit.mean_square_b_m2);
  frame.position_variance = believed / n;
  frame.centre_local_m = fit.mean_b;
  return frame;
}

}  // namespace orchard::pose
