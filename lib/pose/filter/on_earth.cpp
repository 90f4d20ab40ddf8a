// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/on_earth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <string>

#include "geometry/pose2.hpp"
#include "text/number_text.hpp"

namespace orchard::pose {
namespace {

/// derived: closer fixes share their error and add nothing to a fit of metres.
constexpr double kFixSpacing_m = 0.5;

/// derived: at a walking pace a tilt every 0.2 m: five times what a robot's length of ground needs.
constexpr std::int64_t kTiltPeriod_us = 200'000;

/// derived: reflections lead a tenth of the fixes astray without a fault of the path.
constexpr int kFixesPerStray = 10;

geometry::Georeference georeference_of(const GnssAlignment& alignment,
                                       const std::array<double, 3>& datum) {
  geometry::Georeference georeference;
  georeference.latitude_deg = datum[0];
  georeference.longitude_deg = datum[1];
  georeference.altitude_m = datum[2];
  georeference.x_m = alignment.x_y_yaw.x();
  georeference.y_m = alignment.x_y_yaw.y();
  georeference.yaw_rad = alignment.x_y_yaw.z();
  georeference.residual_rms_m = alignment.residual_rms_m;
  return georeference;
}

std::optional<Finding> contradiction_of(const GnssAlignment& alignment) {
  const int num = alignment.num_used + alignment.num_left_out;
  if (kFixesPerStray * alignment.num_contradicting <= num) return std::nullopt;
  return Finding{
      "path_contradicts_fixes", "pose.slam.use_gnss",
      std::to_string(alignment.num_contradicting) + " of " + std::to_string(num) +
          " GNSS fixes lie beside the path, half of them by more than " +
          fixed_text(alignment.contradicting_m, 2) +
          " m, farther than their own errors explain: the map is bent or trees were mistaken for "
          "one another, or the receiver was misled by reflections; map once more with "
          "pose.slam.use_gnss: true (or pose.mode: fused) and compare before using either"};
}

}  // namespace

FixesOfDrive::FixesOfDrive(const GnssConfig& config)
    : p_base_antenna_m_(config.antenna_m[0], config.antenna_m[1], config.antenna_height_m),
      gnss_(config) {}

bool FixesOfDrive::add(const Gnss& gnss) {
  const auto fix = gnss_.add(gnss);
  if (!fix) return false;
  if (fixes_.empty() || (fix->p_enu_m - fixes_.back().p_enu_m).norm() > kFixSpacing_m) {
    fixes_.push_back(*fix);
  }
  return true;
}

bool FixesOfDrive::wants_tilt_at(std::int64_t utime) const {
  return tilts_.empty() || utime - tilts_.back().utime >= kTiltPeriod_us;
}

void FixesOfDrive::add_tilt(std::int64_t utime, const Attitude& tilt) {
  tilts_.push_back({utime, tilt});
}

std::optional<GnssAlignment> FixesOfDrive::alignment_of(const PathAt& path_at) const {
  std::vector<AntennaObservation> observations;
  for (const GnssPosition& fix : fixes_) {
    const auto pose = path_at(fix.utime);
    if (!pose) continue;
    AntennaObservation observation;
    observation.p_enu_m = fix.p_enu_m;
    observation.p_map_m = Eigen::Vector2d(pose->x_m, pose->y_m) +
                          geometry::rotation(pose->yaw_rad) * p_base_antenna_m_.head<2>();
    observation.variance_m2 = 0.5 * fix.covariance.trace();
    observations.push_back(observation);
  }
  return align_to_gnss(observations);
}

GroundProfile FixesOfDrive::ground_along(const PathAt& path_at) const {
  const bool has_height = std::any_of(fixes_.begin(), fixes_.end(),
                                      [](const auto& fix) { return fix.height_variance_m2 > 0.0; });
  if (!has_height) return {};
  std::vector<GroundReading> readings;
  const auto read = [&](std::int64_t utime) {
    const auto pose = path_at(utime);
    if (pose) readings.push_back({utime, pose->x_m, pose->y_m, pose->yaw_rad, {}, 0.0, 0.0});
    return pose.has_value();
  };
  auto tilt = tilts_.begin();
  const auto read_tilts_to = [&](std::int64_t utime) {
    for (; tilt != tilts_.end() && tilt->utime <= utime; ++tilt) {
      if (read(tilt->utime)) readings.back().tilt = tilt->attitude;
    }
  };
  for (const GnssPosition& fix : fixes_) {
    read_tilts_to(fix.utime);
    if (!read(fix.utime)) continue;
    GroundReading& reading = readings.back();
    reading.antenna_height_m = fix.height_m;
    reading.antenna_variance_m2 = fix.height_variance_m2;
    if (tilt != tilts_.begin() && std::abs(fix.utime - std::prev(tilt)->utime) <= kTiltPeriod_us) {
      reading.tilt = std::prev(tilt)->attitude;
    }
  }
  read_tilts_to(std::numeric_limits<std::int64_t>::max());
  return pose::ground_along(readings, p_base_antenna_m_);
}

OnEarth FixesOfDrive::along(const PathAt& path_at) const {
  OnEarth read;
  read.num_fixes = fixes_.size();
  const auto alignment = alignment_of(path_at);
  // Without a georeference nobody could say above what the heights are.
  if (!alignment) return read;
  read.place = georeference_of(*alignment, gnss_.datum().value());
  read.ground = ground_along(path_at);
  read.doubt = contradiction_of(*alignment);
  return read;
}

}  // namespace orchard::pose
