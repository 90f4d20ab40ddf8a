// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/gnss_positions.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>

#include "geometry/georeference.hpp"
#include "geometry/rigid_fit2.hpp"
#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

// physical: fix qualities of NMEA 0183, GGA.
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

// physical: all satellites are above the antenna, so heights are about half as accurate as places.
constexpr double kHeightOverPlace = 2.0;

/// Variance of a fix's altitude [m2]; 0 if the altitude is unknown: stated as such, or the zero of
/// a source that states nothing.
double altitude_variance_m2(const Gnss& gnss) {
  const double stated_m2 = gnss.covariance[5];
  if (stated_m2 >= kUnknownAltitudeVariance_m2) return 0.0;
  if (stated_m2 <= 0.0 && gnss.altitude_m == 0.0) return 0.0;
  const double least_m = kHeightOverPlace * least_sd_m(gnss.fix_quality);
  return std::max(stated_m2, least_m * least_m);
}

// physical: a receiver that works does not repeat a fix exactly while it moves so far.
constexpr double kFreezeTravel_m = 0.5;
// derived: the median of seven steps is that of four good ones.
constexpr std::size_t kMinSteps = 7;

// derived: fixes that spread over twenty standard errors of their mean give a heading to 3 degrees;
// Gaussian residuals exceed four medians once in a thousand; the weights settle within the rounds.
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
  return GnssPosition{gnss.utime,
                      {east_m, north_m},
                      effective_covariance(gnss),
                      gnss.altitude_m - enu->HeightOrigin(),
                      altitude_variance_m2(gnss)};
}

std::optional<std::array<double, 3>> GnssPositions::datum() const {
  const auto& enu = impl_->enu;
  if (!enu) return std::nullopt;
  return std::array<double, 3>{enu->LatitudeOrigin(), enu->LongitudeOrigin(), enu->HeightOrigin()};
}

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
  std::vector<double> contradicting_m;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (off_m[i] > std::max(geometry::kGeoreferenceResidualMax_m,
                            3.0 * std::sqrt(observations[i].variance_m2))) {
      contradicting_m.push_back(off_m[i]);
    }
    if (is_used[i] == 0) {
      ++alignment.num_left_out;
      continue;
    }
    ++alignment.num_used;
    sum2 += off_m[i] * off_m[i];
  }
  if (alignment.num_used < static_cast<int>(kObservationsMin)) return std::nullopt;
  alignment.num_contradicting = static_cast<int>(contradicting_m.size());
  if (!contradicting_m.empty()) alignment.contradicting_m = geometry::median(contradicting_m);
  alignment.x_y_yaw = best.T_a_b.vector();
  alignment.residual_rms_m = std::sqrt(sum2 / alignment.num_used);
  const double spread_wanted_m = std::max(
      kSpreadMin_m, kSpreadScatter * alignment.residual_rms_m / std::sqrt(alignment.num_used));
  if (std::sqrt(best.mean_square_b_m2) < spread_wanted_m) return std::nullopt;
  return alignment;
}

}  // namespace orchard::pose
