// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/satellite_receiver.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/orchard_path.hpp"
#include "simulation/sensor/motion_sensors.hpp"

namespace orchard::simulation {

SatelliteReceiver::SatelliteReceiver(std::uint64_t seed, const SimulationConfig& config)
    : seed_(seed),
      config_(config.gnss),
      motion_(config.motion),
      orchard_(config.orchard),
      sky_(seed, config.gnss.sky) {}

bool SatelliteReceiver::under_canopy(double x_m, double y_m) const {
  if (config_.canopy_fraction <= 0.0) return false;
  const double along_m = y_m - kRowsBegin_m;
  if (along_m < 0.0 || along_m > (orchard_.trees_per_row - 1) * orchard_.tree_spacing_m) {
    return false;
  }
  const auto alley = static_cast<std::uint64_t>(std::llround(x_m / orchard_.row_spacing_m));
  const auto stretch = static_cast<std::uint64_t>(along_m / config_.canopy_length_m);
  Random random(seed_, Stream::kCanopy, (alley << 32) + stretch);
  return random.uniform() < config_.canopy_fraction;
}

std::optional<pose::Gnss> SatelliteReceiver::fix(const DrivePath& path, std::int64_t index,
                                                 double time_s) const {
  if (config_.outage.number_at(time_s) >= 0 || !sky_.is_open(time_s)) return std::nullopt;
  if (const int freeze = config_.freeze.number_at(time_s); freeze >= 0) {
    // Repeat the last fix before, with its noise.
    const double rate_hz = motion_.gnss_rate_hz;
    const double since_s = time_s - config_.freeze.begin_s(freeze);
    const auto back =
        std::min(index, static_cast<std::int64_t>(std::ceil(since_s * rate_hz - 1e-6)));
    index -= back;
    time_s -= static_cast<double>(back) / rate_hz;
  }
  const Pose2 T_map_base = path.pose_at(time_s);
  const Pose2 antenna = compose(T_map_base, {config_.antenna_m[0], config_.antenna_m[1], 0.0});
  double x_m = antenna.x_m, y_m = antenna.y_m;
  double sd_m = motion_.gnss_sd_m;
  double stated_sd_m =
      config_.stated_sd_m > 0.0 ? config_.stated_sd_m : std::hypot(sd_m, sky_.wander_sd_m());
  if (under_canopy(x_m, y_m)) {
    if (config_.canopy_sd_m <= 0.0) return std::nullopt;
    sd_m = stated_sd_m = config_.canopy_sd_m;
  }
  if (const int jump = config_.jump.number_at(time_s); jump >= 0) {
    const double towards_rad = Random(seed_, Stream::kGnssJump, static_cast<std::uint64_t>(jump))
                                   .uniform(-geometry::kPi, geometry::kPi);
    x_m += config_.jump_m * std::cos(towards_rad);
    y_m += config_.jump_m * std::sin(towards_rad);
  }
  const Eigen::Vector2d sky_m = sky_.error_m(time_s);
  x_m += sky_m.x();
  y_m += sky_m.y();
  Random random(seed_, Stream::kGnss, static_cast<std::uint64_t>(index));
  return simulate_gnss(x_m, y_m, motion_.datum, sd_m, stated_sd_m, random);
}

}  // namespace orchard::simulation
