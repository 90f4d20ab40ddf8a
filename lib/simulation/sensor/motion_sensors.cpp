// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/motion_sensors.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <cstdint>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

/// NMEA GGA quality of a receiver that states this standard deviation.
std::int8_t quality_of(double sd_m) {
  if (sd_m <= 0.05) return 4;  // RTK, fixed
  if (sd_m <= 0.5) return 5;   // RTK, float
  return sd_m <= 1.5 ? 2 : 1;  // differential, single
}

}  // namespace

OdometryErrors draw_odometry_errors(const MotionConfig& config, const WheelsConfig& wheels,
                                    Random& random) {
  OdometryErrors errors;
  errors.speed_scale = random.normal(0.0, config.speed_scale_sd);
  errors.yaw_rate_bias_radps = random.normal(0.0, config.yaw_rate_bias_sd_radps);
  errors.yaw_rate_scale = random.normal(0.0, wheels.yaw_rate_scale_sd);
  return errors;
}

pose::Odometry simulate_odometry(const DrivePath& path, double time_s, double period_s,
                                 const OdometryErrors& errors, const MotionConfig& config,
                                 const WheelsConfig& wheels, double turn_slip, Random& random) {
  const Pose2 before = path.pose_at(time_s - period_s);
  const Pose2 now = path.pose_at(time_s);
  const double turn_rad = geometry::wrap_angle_rad(now.yaw_rad - before.yaw_rad);
  const double chord_m = std::hypot(now.x_m - before.x_m, now.y_m - before.y_m);
  // Wheels measure the length of the arc, not of the chord.
  const double half_rad = 0.5 * turn_rad;
  const double arc_m =
      std::abs(half_rad) < 1e-9 ? chord_m : chord_m * half_rad / std::sin(half_rad);

  const bool carried = path.carried_at(time_s) || path.carried_at(time_s - period_s);
  const double slip = std::abs(turn_rad) > 1e-9 ? turn_slip : 0.0;
  const double speed_mps = carried ? 0.0 : arc_m / period_s;
  const double yaw_rate_radps = carried ? 0.0 : turn_rad / period_s;

  pose::Odometry odometry;
  odometry.speed_mps = speed_mps * (1.0 + errors.speed_scale) * (1.0 + slip) +
                       random.normal(0.0, config.speed_sd_mps);
  odometry.yaw_rate_radps = yaw_rate_radps * (1.0 + errors.yaw_rate_scale) * (1.0 + slip) +
                            errors.yaw_rate_bias_radps +
                            random.normal(0.0, config.yaw_rate_sd_radps);
  if (!wheels.states_covariance) return odometry;
  const double slip_sd = slip != 0.0 ? wheels.turn_slip_sd : 0.0;
  const auto squared = [](double value) { return value * value; };
  odometry.covariance = {
      squared(config.speed_sd_mps) +
          squared(std::hypot(config.speed_scale_sd, slip_sd) * speed_mps),
      0.0,
      squared(config.yaw_rate_sd_radps) + squared(config.yaw_rate_bias_sd_radps) +
          squared(std::hypot(wheels.yaw_rate_scale_sd, slip_sd) * yaw_rate_radps)};
  return odometry;
}

pose::Gnss simulate_gnss(double x_m, double y_m, const std::array<double, 3>& datum, double sd_m,
                         double stated_sd_m, Random& random) {
  const GeographicLib::LocalCartesian enu(datum[0], datum[1], datum[2]);
  const double east_m = x_m + random.normal(0.0, sd_m);
  const double north_m = y_m + random.normal(0.0, sd_m);
  const double up_m = random.normal(0.0, 2.0 * sd_m);
  pose::Gnss gnss;
  enu.Reverse(east_m, north_m, up_m, gnss.latitude_deg, gnss.longitude_deg, gnss.altitude_m);
  const double variance_m2 = stated_sd_m * stated_sd_m;
  gnss.covariance = {variance_m2, 0.0, 0.0, variance_m2, 0.0, 4.0 * variance_m2};
  gnss.fix_quality = quality_of(stated_sd_m);
  return gnss;
}

pose::PoseFix simulate_fix(const Pose2& T_map_base, double sd_m, double yaw_sd_rad,
                           Random& random) {
  pose::PoseFix fix;
  fix.x_m = T_map_base.x_m + random.normal(0.0, sd_m);
  fix.y_m = T_map_base.y_m + random.normal(0.0, sd_m);
  fix.yaw_rad = geometry::wrap_angle_rad(T_map_base.yaw_rad + random.normal(0.0, yaw_sd_rad));
  fix.covariance = {sd_m * sd_m, 0.0, 0.0, sd_m * sd_m, 0.0, yaw_sd_rad * yaw_sd_rad};
  fix.has_yaw = true;
  return fix;
}

}  // namespace orchard::simulation
