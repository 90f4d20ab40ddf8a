// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/gnss_monitor.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

/// A receiver is frozen if its fix stays exactly the same over more than this travel [m].
constexpr double kFreezeTravel_m = 0.5;

constexpr std::size_t kMinSteps = 7;

}  // namespace

bool GnssMonitor::is_frozen_at(const Gnss& gnss, double travel_m) {
  const bool same = first_same_ && gnss.latitude_deg == first_same_->latitude_deg &&
                    gnss.longitude_deg == first_same_->longitude_deg;
  travel_m_ = same ? travel_m_ + travel_m : 0.0;
  if (!same) first_same_ = gnss;
  return travel_m_ > kFreezeTravel_m;
}

void GnssMonitor::add_step_error(const Eigen::Vector2d& error_m) {
  steps2_[num_steps_++ % kNumSteps] = error_m.squaredNorm();
}

std::optional<double> GnssMonitor::scatter_m() const {
  const std::size_t count = std::min(num_steps_, kNumSteps);
  if (count < kMinSteps) return std::nullopt;
  const std::vector<double> steps2(steps2_.begin(),
                                   steps2_.begin() + static_cast<std::ptrdiff_t>(count));
  // A step has twice the variance of a fix on each of two axes: its square is exponentially
  // distributed with mean 4 sd^2, and the median is ln 2 times the mean.
  return std::sqrt(geometry::median(steps2) / (4.0 * std::log(2.0)));
}

}  // namespace orchard::pose
