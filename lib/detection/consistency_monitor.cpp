// SPDX-License-Identifier: BSD-3-Clause
#include "detection/consistency_monitor.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "timing/units.hpp"

namespace orchard::detection {
namespace {

/// Message time between two comparisons [s]: edges are costly.
constexpr double kPeriod_s = 1.0;

/// Window of the running median in message time [s]; longer than a single object stays in view.
constexpr double kDisagreementWindow_s = 20.0;

/// Min number of observations for a median.
constexpr int kObjectsMin = 20;

/// Disagreement that raises the warning [deg], once the median is certain to reach it.
constexpr double kWarn_deg = 0.75;

/// Half width of the median's confidence interval [standard deviations]. Among bushes the edges lie
/// anywhere in the search window, and the median of some tens of them is off by chance.
constexpr double kCertain_sigma = 4.0;

/// Median disagreement below which the warning is cleared [deg].
constexpr double kClear_deg = 0.5;

/// Returns the end of the median's confidence interval that is nearer to zero, and zero if that
/// lies within. How many of n values lie below the true median is binomial with variance n / 4,
/// whatever their distribution.
double certain_median(const std::vector<double>& values) {
  const double half_width = 0.5 * kCertain_sigma / std::sqrt(static_cast<double>(values.size()));
  const double low = geometry::quantile(values, std::max(0.0, 0.5 - half_width));
  const double high = geometry::quantile(values, std::min(1.0, 0.5 + half_width));
  return low > 0.0 ? low : std::min(high, 0.0);
}

}  // namespace

ConsistencyMonitor::ConsistencyMonitor(const ConsistencyConfig& config, double focal_px)
    : config_(config), focal_px_(focal_px) {}

bool ConsistencyMonitor::is_due(std::int64_t utime) const {
  if (!config_.enabled) return false;
  return last_utime_ == INT64_MIN || timing::seconds(utime - last_utime_) >= kPeriod_s;
}

void ConsistencyMonitor::add(std::int64_t utime, const std::vector<double>& offsets_px) {
  if (first_utime_ == INT64_MIN) first_utime_ = utime;
  if (raised_) raised_us_ += utime - last_utime_;
  last_utime_ = utime;
  for (const double offset_px : offsets_px) observations_.push_back({utime, offset_px});
  while (!observations_.empty() &&
         timing::seconds(utime - observations_.front().utime) > kDisagreementWindow_s) {
    observations_.pop_front();
  }
  const bool is_long = timing::seconds(utime - first_utime_) >= kDisagreementWindow_s;
  if (!is_long || num_observations() < kObjectsMin) return;  // too few: keep the state
  std::vector<double> values;
  values.reserve(observations_.size());
  for (const Observation& observation : observations_) values.push_back(observation.offset_px);
  median_px_ = geometry::median(values);
  raised_ = raised_ ? std::abs(degrees(median_px_)) >= kClear_deg
                    : std::abs(degrees(certain_median(values))) >= kWarn_deg;
  if (raised_ && std::abs(median_px_) > std::abs(worst_px_)) worst_px_ = median_px_;
}

double ConsistencyMonitor::degrees(double offset_px) const {
  return std::atan(offset_px / focal_px_) * 180.0 / geometry::kPi;
}

std::string ConsistencyMonitor::disagreement(const char* verb, double offset_px,
                                             double duration_s) const {
  return fmt::format(
      "laser and image edges {} by {:.1f} px ({:.1f} deg, image to the {}) for {:.0f} s: check "
      "camera.phi_rad (orchard calibrate laser-camera) or camera.delay_s (orchard "
      "calibrate delay)",
      verb, std::abs(offset_px), std::abs(degrees(offset_px)), offset_px > 0.0 ? "right" : "left",
      duration_s);
}

std::string ConsistencyMonitor::warning() const {
  if (!raised_) return {};
  return disagreement("disagree", median_px_, kDisagreementWindow_s + timing::seconds(raised_us_));
}

std::string ConsistencyMonitor::run_summary() const {
  if (worst_px_ == 0.0) return {};
  return disagreement("disagreed", worst_px_, kDisagreementWindow_s + timing::seconds(raised_us_));
}

}  // namespace orchard::detection
