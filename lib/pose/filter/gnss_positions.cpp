// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/gnss_positions.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>

namespace orchard::pose {
namespace {

constexpr std::int8_t kNoFix = 0;
constexpr std::int8_t kDifferential = 2;
constexpr std::int8_t kFixed = 4;
constexpr std::int8_t kFloat = 5;

double least_sd_m(std::int8_t quality) {
  switch (quality) {
    case kFixed:
      return GnssConfig::kSdFixed_m;
    case kFloat:
      return GnssConfig::kSdFloat_m;
    case kDifferential:
      return GnssConfig::kSdDifferential_m;
    default:
      return GnssConfig::kSdSingle_m;
  }
}

Eigen::Matrix2d effective_covariance(const Gnss& gnss) {
  const double sd_m = least_sd_m(gnss.fix_quality);
  const double ee = gnss.covariance[0], en = gnss.covariance[1], nn = gnss.covariance[3];
  Eigen::Matrix2d covariance;
  covariance << std::max(ee, sd_m * sd_m), en, en, std::max(nn, sd_m * sd_m);
  // Drop a correlation that makes the covariance (nearly) singular or indefinite.
  if (en * en >= 0.98 * covariance(0, 0) * covariance(1, 1)) {
    covariance(0, 1) = covariance(1, 0) = 0.0;
  }
  return covariance;
}

}  // namespace

struct GnssPositions::Impl {
  GnssConfig config;
  std::optional<GeographicLib::LocalCartesian> enu;
};

GnssPositions::GnssPositions(const GnssConfig& config) : impl_(std::make_unique<Impl>()) {
  impl_->config = config;
  const auto& [latitude_deg, longitude_deg, altitude_m] = config.datum;
  if (latitude_deg != 0.0 || longitude_deg != 0.0 || altitude_m != 0.0) {
    impl_->enu.emplace(latitude_deg, longitude_deg, altitude_m);
  }
}
GnssPositions::~GnssPositions() = default;
GnssPositions::GnssPositions(GnssPositions&&) noexcept = default;
GnssPositions& GnssPositions::operator=(GnssPositions&&) noexcept = default;

std::optional<GnssPosition> GnssPositions::add(const Gnss& gnss) {
  if (gnss.fix_quality == kNoFix) return std::nullopt;
  auto& enu = impl_->enu;
  if (!enu) enu.emplace(gnss.latitude_deg, gnss.longitude_deg, gnss.altitude_m);
  double east_m = 0.0, north_m = 0.0, up_m = 0.0;
  enu->Forward(gnss.latitude_deg, gnss.longitude_deg, gnss.altitude_m, east_m, north_m, up_m);
  if (!std::isfinite(east_m) || !std::isfinite(north_m)) return std::nullopt;
  return GnssPosition{gnss.utime, {east_m, north_m}, effective_covariance(gnss)};
}

std::optional<std::array<double, 3>> GnssPositions::datum() const {
  const auto& enu = impl_->enu;
  if (!enu) return std::nullopt;
  return std::array<double, 3>{enu->LatitudeOrigin(), enu->LongitudeOrigin(), enu->HeightOrigin()};
}

}  // namespace orchard::pose
