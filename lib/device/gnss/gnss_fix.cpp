// SPDX-License-Identifier: BSD-3-Clause
#include "device/gnss/gnss_fix.hpp"

#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"

namespace orchard::device {
namespace {

enum Quality : std::int8_t {
  kNoFix = 0,
  kSingle = 1,
  kDifferential = 2,
  kMilitary = 3,
  kRtkFixed = 4,
  kRtkFloat = 5,
  kEstimated = 6,
  kSurveyed = 7,
  kSimulated = 8,
};

constexpr double kUnknownHeightVariance_m2 = 1e4;
constexpr double kMaxOfRtk_m = 1.0;  // above, eph is not the error of the RTK solution

bool is_rtk(std::int8_t quality) { return quality == kRtkFixed || quality == kRtkFloat; }

/// Covariance from the error ellipse, else from the standard deviations; false without both.
bool from_noise(const GpsdNoise& noise, std::array<double, 6>& covariance) {
  auto& [ee, en, eu, nn, nu, uu] = covariance;
  if (noise.major_sd_m && noise.minor_sd_m && noise.orientation_deg && *noise.major_sd_m > 0.0) {
    const double angle_rad = *noise.orientation_deg * geometry::kPi / 180.0;
    const double sine = std::sin(angle_rad), cosine = std::cos(angle_rad);
    const double major = geometry::square(*noise.major_sd_m),
                 minor = geometry::square(*noise.minor_sd_m);
    ee = major * sine * sine + minor * cosine * cosine;
    nn = major * cosine * cosine + minor * sine * sine;
    en = (major - minor) * sine * cosine;
  } else if (noise.north_sd_m && noise.east_sd_m && *noise.north_sd_m > 0.0 &&
             *noise.east_sd_m > 0.0) {
    ee = geometry::square(*noise.east_sd_m);
    nn = geometry::square(*noise.north_sd_m);
  } else {
    return false;
  }
  uu = noise.up_sd_m && *noise.up_sd_m > 0.0 ? geometry::square(*noise.up_sd_m)
                                             : kUnknownHeightVariance_m2;
  return true;
}

}  // namespace

std::int8_t gga_quality(const GpsdFix& fix) {
  if (fix.mode < 2) return kNoFix;
  // gpsd_json(5), TPV, status. An absent status means a plain fix.
  constexpr std::array<std::int8_t, 10> kByStatus{kSingle,    kSingle,    kDifferential, kRtkFixed,
                                                  kRtkFloat,  kEstimated, kEstimated,    kSurveyed,
                                                  kSimulated, kMilitary};
  return kByStatus[static_cast<std::size_t>(fix.status)];
}

std::string quality_name(std::int8_t quality) {
  constexpr std::array<const char*, 9> kNames{"no fix",    "single",    "differential",
                                              "military",  "RTK fixed", "RTK float",
                                              "estimated", "surveyed",  "simulated"};
  return kNames.at(static_cast<std::size_t>(quality));
}

std::array<double, 6> enu_covariance(const GpsdFix& fix, const GpsdNoise* noise) {
  std::array<double, 6> covariance{};
  if (noise != nullptr && from_noise(*noise, covariance)) return covariance;
  double east_sd_m = 0.0, north_sd_m = 0.0;
  if (fix.eph_m && *fix.eph_m > 0.0) {
    east_sd_m = north_sd_m = *fix.eph_m;
  } else if (fix.epx_m && fix.epy_m && *fix.epx_m > 0.0 && *fix.epy_m > 0.0) {
    east_sd_m = *fix.epx_m;
    north_sd_m = *fix.epy_m;
  } else {
    return covariance;
  }
  if (is_rtk(gga_quality(fix)) && std::max(east_sd_m, north_sd_m) > kMaxOfRtk_m) return covariance;
  covariance[0] = geometry::square(east_sd_m);
  covariance[3] = geometry::square(north_sd_m);
  covariance[5] = fix.mode == 3 && fix.epv_m && *fix.epv_m > 0.0 ? geometry::square(*fix.epv_m)
                                                                 : kUnknownHeightVariance_m2;
  return covariance;
}

std::optional<pose::Gnss> to_measurement(const GpsdFix& fix, const GpsdNoise* noise) {
  if (fix.mode < 2 || !fix.latitude_deg || !fix.longitude_deg) return std::nullopt;
  pose::Gnss gnss;
  gnss.latitude_deg = *fix.latitude_deg;
  gnss.longitude_deg = *fix.longitude_deg;
  gnss.altitude_m = fix.altitude_m.value_or(0.0);
  gnss.covariance = enu_covariance(fix, noise);
  if (!fix.altitude_m && gnss.covariance[0] > 0.0) gnss.covariance[5] = kUnknownHeightVariance_m2;
  gnss.fix_quality = gga_quality(fix);
  return gnss;
}

}  // namespace orchard::device
