// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/motion_sensors.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::simulation {

OdometryErrors draw_odometry_errors(const MotionConfig& config, Random& random) {
  OdometryErrors errors;
  errors.speed_scale = random.normal(0.0, config.speed_scale_sd);
  errors.yaw_rate_bias_radps = random.normal(0.0, config.yaw_rate_bias_sd_radps);
  return errors;
}

pose::Odometry simulate_odometry(const DrivePath& path, double time_s, double period_s,
                                 const OdometryErrors& errors, const MotionConfig& config,
                                 Random& random) {
  const Pose2 before = path.pose_at(time_s - period_s);
  const Pose2 now = path.pose_at(time_s);
  const double turn_rad = geometry::wrap_angle_rad(now.yaw_rad - before.yaw_rad);
  const double chord_m = std::hypot(now.x_m - before.x_m, now.y_m - before.y_m);
  // wheels roll along the arc
  const double half_rad = 0.5 * turn_rad;
  const double arc_m =
      std::abs(half_rad) < 1e-9 ? chord_m : chord_m * half_rad / std::sin(half_rad);

  pose::Odometry odometry;
  odometry.speed_mps =
      arc_m / period_s * (1.0 + errors.speed_scale) + random.normal(0.0, config.speed_sd_mps);
  odometry.yaw_rate_radps = turn_rad / period_s + errors.yaw_rate_bias_radps +
                            random.normal(0.0, config.yaw_rate_sd_radps);
  const double scale_sd_mps = config.speed_scale_sd * arc_m / period_s;
  odometry.covariance = {config.speed_sd_mps * config.speed_sd_mps + scale_sd_mps * scale_sd_mps,
                         0.0,
                         config.yaw_rate_sd_radps * config.yaw_rate_sd_radps +
                             config.yaw_rate_bias_sd_radps * config.yaw_rate_bias_sd_radps};
  return odometry;
}

pose::Gnss simulate_gnss(const Pose2& T_map_base, const MotionConfig& config, Random& random) {
  const GeographicLib::LocalCartesian enu(config.datum[0], config.datum[1], config.datum[2]);
  const double sd_m = config.gnss_sd_m;
  const double east_m = T_map_base.x_m + random.normal(0.0, sd_m);
  const double north_m = T_map_base.y_m + random.normal(0.0, sd_m);
  const double up_m = random.normal(0.0, 2.0 * sd_m);
  pose::Gnss gnss;
  enu.Reverse(east_m, north_m, up_m, gnss.latitude_deg, gnss.longitude_deg, gnss.altitude_m);
  gnss.covariance = {sd_m * sd_m, 0.0, 0.0, sd_m * sd_m, 0.0, 4.0 * sd_m * sd_m};
  gnss.fix_quality = 4;  // RTK
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
