// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/heading_start.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::pose {
namespace {

constexpr std::size_t kPairsMost = 200;
constexpr double kSpreadSigma = 6.0;

}  // namespace

std::optional<LocalFrame> HeadingStart::add(const Eigen::Vector2d& p_local_m,
                                            const Eigen::Vector2d& p_map_m, double variance_m2) {
  if (pairs_.size() == kPairsMost) pairs_.erase(pairs_.begin());
  pairs_.push_back({p_local_m, p_map_m, variance_m2});

  Eigen::Vector2d local_m = Eigen::Vector2d::Zero(), map_m = Eigen::Vector2d::Zero();
  double variance = 0.0;
  const double n = static_cast<double>(pairs_.size());
  for (const Pair& p : pairs_) {
    local_m += p.p_local_m / n;
    map_m += p.p_map_m / n;
    variance += p.variance_m2 / n;
  }
  // The turn that lays one set of points upon the other: the angle of their summed products.
  double dot = 0.0, cross = 0.0, spread2 = 0.0, reach2 = 0.0;
  for (const Pair& p : pairs_) {
    const Eigen::Vector2d a = p.p_local_m - local_m, b = p.p_map_m - map_m;
    dot += a.dot(b);
    cross += a.x() * b.y() - a.y() * b.x();
    spread2 += a.squaredNorm();
    reach2 = std::max(reach2, (p.p_local_m - pairs_.front().p_local_m).squaredNorm());
  }
  if (pairs_.size() < 3 || reach2 < baseline_m_ * baseline_m_) return std::nullopt;

  const double yaw_rad = std::atan2(cross, dot);
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  double misfit2 = 0.0;
  for (const Pair& p : pairs_) {
    const Eigen::Vector2d a = p.p_local_m - local_m;
    const Eigen::Vector2d laid =
        map_m + Eigen::Vector2d(c * a.x() - s * a.y(), s * a.x() + c * a.y());
    misfit2 += (p.p_map_m - laid).squaredNorm() / (2.0 * n);
  }
  // Receivers claim too much: what the points scatter counts if it is more.
  const double believed = std::max(variance, misfit2);
  if (reach2 < kSpreadSigma * kSpreadSigma * believed) {
    if (pairs_.size() == kPairsMost && misfit2 > variance) {
      // A jump or a long drift in it: what comes next may do better without the oldest.
      pairs_.erase(pairs_.begin(), pairs_.begin() + static_cast<std::ptrdiff_t>(kPairsMost / 2));
    }
    return std::nullopt;
  }
  LocalFrame frame;
  frame.x_y_yaw.head<2>() =
      map_m - Eigen::Vector2d(c * local_m.x() - s * local_m.y(), s * local_m.x() + c * local_m.y());
  frame.x_y_yaw.z() = yaw_rad;
  frame.yaw_variance = believed / spread2;
  frame.position_variance = believed / n;
  frame.centre_local_m = local_m;
  return frame;
}

}  // namespace orchard::pose
