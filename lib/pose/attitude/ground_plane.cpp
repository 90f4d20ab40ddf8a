// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/ground_plane.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "pose/tuning.hpp"

namespace orchard::pose {
namespace {

using geometry::square;

// derived: of five bodies' lengths a scatter is known to a third.
constexpr double kHeldAsWay_m = 5.0 * kBody_m;

}  // namespace

void GroundPlane::add(const Attitude& attitude, double distance_m, double turn_rad) {
  const Eigen::Vector2d seen = gradient_under(attitude);
  if (!is_started_) {
    is_started_ = true;
    gradient_ = seen;
    variance_ = square(kStartSlopeSd);
    return;
  }
  gradient_ = geometry::rotation(-turn_rad) * gradient_;
  driven_m_ = std::min(memory_m_, driven_m_ + distance_m);
  const double of_plane = distance_m / std::max(kBody_m, driven_m_);
  gradient_ += (1.0 - std::exp(-of_plane)) * (seen - gradient_);
  // A scatter takes longer to know than a mean: what is held before counts as that much way.
  const double of_scatter = distance_m / (kHeldAsWay_m + driven_m_);
  variance_ += (1.0 - std::exp(-of_scatter)) * (0.5 * (seen - gradient_).squaredNorm() - variance_);
}

/// Slopes of one body's length are independent of those of the next: heights walk at random, and
/// the plane is the mean of as many as were driven on.
laser::OverGround GroundPlane::below(double height_m, const Eigen::Vector2d& rise) const {
  const double of_plane = kBody_m / std::max(kBody_m, 2.0 * driven_m_);
  const Eigen::Vector2d over = rise - gradient_;
  return {static_cast<float>(height_m),
          static_cast<float>(over.x()),
          static_cast<float>(over.y()),
          static_cast<float>(variance_ * square(kBody_m)),
          static_cast<float>(variance_ * kBody_m),
          static_cast<float>(variance_ * of_plane + square(kMountSd_rad))};
}

}  // namespace orchard::pose
