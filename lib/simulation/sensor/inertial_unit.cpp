// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/inertial_unit.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

constexpr double kWalkStep_s = 1.0;
constexpr double kGravity_mps2 = 9.80665;

double squared(double value) { return value * value; }

}  // namespace

InertialUnit::InertialUnit(std::uint64_t seed, const ImuConfig& config, double duration_s)
    : seed_(seed), config_(config) {
  Random random(seed, Stream::kImuRun);
  double bias_radps = random.normal(0.0, config.yaw_rate_bias_sd_radps);
  for (double& bias_mps2 : acceleration_bias_mps2_) {
    bias_mps2 = random.normal(0.0, config.acceleration_bias_sd_mps2);
  }
  yaw_bias_rad_ = random.normal(0.0, config.yaw_bias_sd_rad);
  if (config.rate_hz <= 0.0) return;
  const double step_sd_radps = config.yaw_rate_walk * std::sqrt(kWalkStep_s);
  for (double t_s = 0.0; t_s < duration_s + 2.0 * kWalkStep_s; t_s += kWalkStep_s) {
    bias_radps_.push_back(bias_radps);
    bias_radps += random.normal(0.0, step_sd_radps);
  }
}

double InertialUnit::yaw_rate_bias_radps(double time_s) const {
  if (bias_radps_.empty()) return 0.0;
  const double at =
      std::clamp(time_s / kWalkStep_s, 0.0, static_cast<double>(bias_radps_.size() - 1));
  const auto before = std::min(static_cast<std::size_t>(at), bias_radps_.size() - 1);
  const std::size_t after = std::min(before + 1, bias_radps_.size() - 1);
  const double fraction = at - static_cast<double>(before);
  return (1.0 - fraction) * bias_radps_[before] + fraction * bias_radps_[after];
}

pose::Imu InertialUnit::sample(const DrivePath& path, std::int64_t index, double time_s) const {
  Random random(seed_, Stream::kImu, static_cast<std::uint64_t>(index));
  const double yaw_rate_radps = path.yaw_rate_at(time_s);
  const bool drives = !path.carried_at(time_s) && time_s >= 0.0 && time_s < path.duration_s();
  pose::Imu imu;
  for (double& rate_radps : imu.angular_rate_radps) {
    rate_radps = random.normal(0.0, config_.angular_rate_sd_radps);
  }
  imu.angular_rate_radps[2] += yaw_rate_radps + yaw_rate_bias_radps(time_s);
  for (double& force_mps2 : imu.acceleration_mps2) {
    force_mps2 = random.normal(0.0, config_.acceleration_sd_mps2);
  }
  imu.acceleration_mps2[0] += acceleration_bias_mps2_[0];
  // Centripetal acceleration at constant speed on arcs.
  imu.acceleration_mps2[1] +=
      acceleration_bias_mps2_[1] + (drives ? path.speed_mps() * yaw_rate_radps : 0.0);
  imu.acceleration_mps2[2] += kGravity_mps2;
  imu.angular_rate_variance = squared(config_.angular_rate_sd_radps);
  imu.acceleration_variance = squared(config_.acceleration_sd_mps2);
  if (config_.orientation) {
    const double sd_rad = config_.orientation_sd_rad;
    imu.has_orientation = true;
    imu.roll_rad = random.normal(0.0, sd_rad);
    imu.pitch_rad = random.normal(0.0, sd_rad);
    imu.yaw_rad = geometry::wrap_angle_rad(path.pose_at(time_s).yaw_rad + yaw_bias_rad_ +
                                           random.normal(0.0, sd_rad));
    imu.orientation_variance = squared(sd_rad) + squared(config_.yaw_bias_sd_rad);
  }
  return imu;
}

}  // namespace orchard::simulation
