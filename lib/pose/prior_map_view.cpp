// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map_view.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "pose/planar.hpp"

namespace orchard::pose {
namespace {

constexpr double kSecondsPerMicrosecond = 1e-6;

/// A scan lasts no longer; a sighting that claims to be farther from its scan is not moved.
constexpr double kMaxScanS = 1.0;

/// What lies this much behind a sighting is behind it, not it.
constexpr double kBehindM = 0.3;
/// A trunk is hidden when its middle is nearer to the shadow's edge than this.
constexpr double kHalfTrunkM = 0.08;

}  // namespace

std::vector<Sighting> sightings_at_scan(const SeenTrunks& seen, double speed_mps,
                                        double yaw_rate_radps, const PriorMapConfig& config) {
  std::vector<Sighting> sightings;
  sightings.reserve(seen.trunks.size());
  const double sd2 = config.sighting_sd_m * config.sighting_sd_m;
  for (const SeenTrunk& trunk : seen.trunks) {
    Sighting s;
    s.p_base = {trunk.x_base_m, trunk.y_base_m};
    s.covariance << trunk.covariance[0], trunk.covariance[1], trunk.covariance[1],
        trunk.covariance[2];
    const bool sound = s.p_base.allFinite() && s.covariance.allFinite() &&
                       s.covariance(0, 0) >= 0.0 && s.covariance(1, 1) >= 0.0 &&
                       s.covariance.determinant() >= 0.0 && std::isfinite(trunk.width_m);
    if (!sound || s.p_base.norm() > config.sighting_range_max_m) continue;
    s.covariance += sd2 * Eigen::Matrix2d::Identity();
    s.width_m = std::max(0.0, trunk.width_m);
    s.width_sd_m = std::isfinite(trunk.width_sd_m) ? std::max(0.0, trunk.width_sd_m) : 1.0;
    const double dt_s = static_cast<double>(trunk.utime - seen.utime) * kSecondsPerMicrosecond;
    if (std::abs(dt_s) <= kMaxScanS) {
      const double turn_rad = yaw_rate_radps * dt_s;
      const Eigen::Vector3d T_scan_then(speed_mps * dt_s * std::cos(0.5 * turn_rad),
                                        speed_mps * dt_s * std::sin(0.5 * turn_rad), turn_rad);
      s.p_base = transform(T_scan_then, s.p_base);
      const Eigen::Matrix2d R = rotation(turn_rad);
      s.covariance = R * s.covariance * R.transpose();
    }
    sightings.push_back(s);
  }
  return sightings;
}

std::size_t SightField::bin(const Eigen::Vector2d& p_base) {
  const double turn = std::atan2(p_base.y(), p_base.x()) / (2.0 * geometry::kPi) + 0.5;
  return std::min(kBins - 1, static_cast<std::size_t>(turn * static_cast<double>(kBins)));
}

void SightField::learn(const std::vector<Sighting>& sightings) {
  for (const Sighting& s : sightings) {
    int& seen = num_seen_[bin(s.p_base)];
    seen = std::min(seen + 1, kSureSightings);
    farthest_m_ = std::max(farthest_m_, s.p_base.norm());
  }
}

bool SightField::covers(const Eigen::Vector2d& p_base) const {
  return p_base.norm() < range_m() && num_seen_[bin(p_base)] >= kSureSightings;
}

double SightField::range_m() const { return std::min(sure_range_m_, kSureFraction * farthest_m_); }

Shadows::Shadows(const std::vector<Sighting>& sightings) {
  for (const Sighting& s : sightings) {
    const double range_m = s.p_base.norm();
    if (range_m < 1e-3) continue;
    shadows_.push_back({s.p_base / range_m, range_m, 0.5 * s.width_m + kHalfTrunkM});
  }
}

bool Shadows::hide(const Eigen::Vector2d& p_base) const {
  for (const Shadow& shadow : shadows_) {
    const double along_m = shadow.direction.dot(p_base);
    if (along_m < shadow.range_m + kBehindM) continue;
    const double across_m =
        std::abs(shadow.direction.x() * p_base.y() - shadow.direction.y() * p_base.x());
    if (across_m < shadow.half_width_m * along_m / shadow.range_m + kHalfTrunkM) return true;
  }
  return false;
}

}  // namespace orchard::pose
