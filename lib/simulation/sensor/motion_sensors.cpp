// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/motion_sensors.hpp"

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

/// NMEA GGA quality of a receiver that states this standard deviation.
std::int8_t quality_of(double sd_m) {
  if (sd_m <= 0.05) return 4;  // RTK, fixed
  if (sd_m <= 0.5) return 5;   // RTK, float
  return sd_m <= 1.5 ? 2 : 1;  // differential, single
}

/// A value at a time, of one value per second; 0 of none.
double interpolated(const std::vector<double>& seconds, double time_s) {
  if (seconds.empty()) return 0.0;
  const double at = std::clamp(time_s, 0.0, static_cast<double>(seconds.size() - 1));
  const auto before = static_cast<std::size_t>(at);
  const std::size_t after = std::min(before + 1, seconds.size() - 1);
  const double fraction = at - static_cast<double>(before);
  return (1.0 - fraction) * seconds[before] + fraction * seconds[after];
}

double squared(double value) { return value * value; }

constexpr double kDay_s = 86400.0;

/// Steps of the slowly varying error per time constant; linear interpolation between them.
constexpr double kStepsPerTime = 10.0;

/// Max number of steps per day.
constexpr double kStepsMax = 1e6;

enum Part : std::uint64_t { kGaps, kPauses, kReflections, kWander, kWanderUp };

/// Draws a duration from the exponential distribution.
double exponential(double mean, Random& random) { return -mean * std::log(1.0 - random.uniform()); }

/// An Ornstein-Uhlenbeck process in its exact discrete form, a value per second.
std::vector<double> draw_drift(Random& random, double sd, double time_s, double duration_s) {
  std::vector<double> values;
  const double kept = std::exp(-1.0 / time_s);
  const double fresh_sd = sd * std::sqrt(1.0 - kept * kept);
  double value = random.normal(0.0, sd);
  for (double t_s = 0.0; t_s <= duration_s + 2.0; t_s += 1.0) {
    values.push_back(value);
    value = kept * value + random.normal(0.0, fresh_sd);
  }
  return values;
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
                                 const WheelsConfig& wheels, Random& random,
                                 const WheeledBody& body) {
  const Pose2 before = path.pose_at(time_s - period_s);
  const Pose2 now = path.pose_at(time_s);
  double turn_rad = geometry::wrap_angle_rad(now.yaw_rad - before.yaw_rad);
  double chord_m = std::hypot(now.x_m - before.x_m, now.y_m - before.y_m);
  if (!body.is_level()) {
    // Wheels roll on the surface, and turn the body about its own vertical.
    const Eigen::Isometry3d motion =
        body.stand_at(before).transform().inverse(Eigen::Isometry) * body.stand_at(now).transform();
    const Eigen::AngleAxisd turned(motion.linear());
    turn_rad = turned.angle() * turned.axis().z();
    chord_m = motion.translation().norm();
  }
  // Wheels measure the length of the arc, not of the chord.
  const double half_rad = 0.5 * turn_rad;
  const double arc_m =
      std::abs(half_rad) < 1e-9 ? chord_m : chord_m * half_rad / std::sin(half_rad);

  const bool carried = path.carried_at(time_s) || path.carried_at(time_s - period_s);
  const double speed_mps = carried ? 0.0 : arc_m / period_s;
  const double yaw_rate_radps = carried ? 0.0 : turn_rad / period_s;

  pose::Odometry odometry;
  odometry.speed_mps =
      speed_mps * (1.0 + errors.speed_scale) + random.normal(0.0, config.speed_sd_mps);
  odometry.yaw_rate_radps = yaw_rate_radps * (1.0 + errors.yaw_rate_scale) +
                            errors.yaw_rate_bias_radps +
                            random.normal(0.0, config.yaw_rate_sd_radps);
  if (!wheels.states_covariance) return odometry;
  odometry.covariance = {
      squared(config.speed_sd_mps) + squared(config.speed_scale_sd * speed_mps), 0.0,
      squared(config.yaw_rate_sd_radps) + squared(config.yaw_rate_bias_sd_radps) +
          squared(wheels.yaw_rate_scale_sd * yaw_rate_radps)};
  return odometry;
}

pose::Gnss simulate_gnss(double x_m, double y_m, const std::array<double, 3>& datum, double sd_m,
                         double stated_sd_m, Random& random, double z_m) {
  const GeographicLib::LocalCartesian enu(datum[0], datum[1], datum[2]);
  const double east_m = x_m + random.normal(0.0, sd_m);
  const double north_m = y_m + random.normal(0.0, sd_m);
  const double up_m = z_m + random.normal(0.0, 2.0 * sd_m);
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

WheelErrorModel::WheelErrorModel(std::uint64_t seed, const WheelsConfig& config, double duration_s)
    : seed_(seed), config_(config) {
  if (config.bias_wander_sd_radps <= 0.0) return;
  Random random(seed, Stream::kWheelBias);
  bias_radps_ = draw_drift(random, config.bias_wander_sd_radps, config.bias_wander_s, duration_s);
}

/// Smooth noise over the ground with standard deviation 1: patches of surface_m.
double WheelErrorModel::ground(std::uint64_t layer, double x_m, double y_m) const {
  const double u = x_m / config_.surface_m, w = y_m / config_.surface_m;
  const double i = std::floor(u), j = std::floor(w);
  double sum = 0.0, weight2 = 0.0;
  for (const double di : {0.0, 1.0}) {
    for (const double dj : {0.0, 1.0}) {
      const double weight = (1.0 - std::abs(u - i - di)) * (1.0 - std::abs(w - j - dj));
      const auto cell =
          static_cast<std::uint64_t>(static_cast<std::int64_t>(i + di)) * 0x9e3779b1u ^
          static_cast<std::uint64_t>(static_cast<std::int64_t>(j + dj)) * 0x85ebca77u;
      sum += weight * Random(seed_ ^ (layer << 56), Stream::kSurface, cell).normal();
      weight2 += weight * weight;
    }
  }
  return sum / std::sqrt(weight2);
}

OdometryErrors WheelErrorModel::errors_at(const OdometryErrors& run, double time_s,
                                          const Pose2& T_map_base) const {
  OdometryErrors errors = run;
  if (config_.surface_slip_sd > 0.0) {
    errors.speed_scale += config_.surface_slip_sd * ground(0, T_map_base.x_m, T_map_base.y_m);
  }
  if (config_.surface_turn_slip_sd > 0.0) {
    errors.yaw_rate_scale +=
        config_.surface_turn_slip_sd * ground(1, T_map_base.x_m, T_map_base.y_m);
  }
  if (config_.load_sd > 0.0) {
    const auto load = static_cast<std::uint64_t>(std::max(0.0, time_s) / config_.load_every_s);
    errors.speed_scale += Random(seed_, Stream::kLoad, load).normal(0.0, config_.load_sd);
  }
  errors.yaw_rate_bias_radps += interpolated(bias_radps_, time_s);
  return errors;
}

InertialUnit::InertialUnit(std::uint64_t seed, const ImuConfig& config, double duration_s,
                           bool is_level)
    : seed_(seed), config_(config) {
  Random random(seed, Stream::kImuRun);
  double bias_radps = random.normal(0.0, config.yaw_rate_bias_sd_radps);
  for (double& bias_mps2 : acceleration_bias_mps2_) {
    bias_mps2 = random.normal(0.0, config.acceleration_bias_sd_mps2);
  }
  yaw_bias_rad_ = random.normal(0.0, config.yaw_bias_sd_rad);
  if (config.rate_hz <= 0.0) return;
  const double step_sd_radps = config.yaw_rate_walk;
  for (double t_s = 0.0; t_s < duration_s + 2.0; t_s += 1.0) {
    bias_radps_.push_back(bias_radps);
    bias_radps += random.normal(0.0, step_sd_radps);
  }
  Random attitude(seed, Stream::kImuAttitude);
  if (!is_level) {
    for (double& bias : tilt_rate_bias_radps_) {
      bias = attitude.normal(0.0, config.yaw_rate_bias_sd_radps);
    }
  }
  if (config.attitude_drift_sd_rad <= 0.0) return;
  for (auto* drift : {&roll_drift_rad_, &pitch_drift_rad_}) {
    *drift =
        draw_drift(attitude, config.attitude_drift_sd_rad, config.attitude_drift_s, duration_s);
  }
}

double InertialUnit::yaw_rate_bias_radps(double time_s) const {
  return interpolated(bias_radps_, time_s);
}

pose::Imu InertialUnit::sample(const DrivePath& path, std::int64_t index, double time_s,
                               const WheeledBody& body) const {
  Random random(seed_, Stream::kImu, static_cast<std::uint64_t>(index));
  const BodyMotion motion = body.motion_at(path, time_s);
  pose::Imu imu;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double bias_radps = axis == 2 ? yaw_rate_bias_radps(time_s) : tilt_rate_bias_radps_[axis];
    imu.angular_rate_radps[axis] = random.normal(0.0, config_.angular_rate_sd_radps) +
                                   (motion.angular_rate_radps[axis] + bias_radps);
  }
  const double shaken_mps2 = std::hypot(config_.acceleration_sd_mps2, config_.vibration_sd_mps2);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double bias_mps2 = axis == 2 ? 0.0 : acceleration_bias_mps2_[axis];
    imu.acceleration_mps2[axis] =
        random.normal(0.0, shaken_mps2) + (bias_mps2 + motion.specific_force_mps2[axis]);
  }
  imu.angular_rate_variance = squared(config_.angular_rate_sd_radps);
  imu.acceleration_variance = squared(config_.acceleration_sd_mps2);
  if (config_.orientation) {
    const double sd_rad = config_.orientation_sd_rad;
    const Pose3 pose = body.stand_at(path.pose_at(time_s));
    imu.has_orientation = true;
    imu.roll_rad =
        random.normal(0.0, sd_rad) + (pose.roll_rad + interpolated(roll_drift_rad_, time_s));
    imu.pitch_rad =
        random.normal(0.0, sd_rad) + (pose.pitch_rad + interpolated(pitch_drift_rad_, time_s));
    imu.yaw_rad = geometry::wrap_angle_rad(pose.horizontal.yaw_rad + yaw_bias_rad_ +
                                           random.normal(0.0, sd_rad));
    imu.orientation_variance = squared(sd_rad) + squared(config_.yaw_bias_sd_rad);
  }
  return imu;
}

ReceiverSky::ReceiverSky(std::uint64_t seed, const SkyConfig& config) : config_(config) {
  const auto no_offset = [](Random&) { return Eigen::Vector2d(0.0, 0.0); };
  if (config.gap_every_s > 0.0) {
    const auto length_s = [&](Random& random) {  // uniform in its logarithm
      return config.gap_min_s * std::pow(config.gap_max_s / config.gap_min_s, random.uniform());
    };
    gaps_ = draw_episodes(seed, kGaps, config.gap_every_s, length_s, no_offset);
  }
  if (config.burst_s > 0.0 && config.pause_s > 0.0) {
    const auto length_s = [&](Random& random) { return exponential(config.pause_s, random); };
    pauses_ = draw_episodes(seed, kPauses, config.burst_s, length_s, no_offset);
  }
  if (config.multipath_fraction > 0.0) {
    const double between_s =
        config.multipath_for_s * (1.0 - config.multipath_fraction) / config.multipath_fraction;
    const auto length_s = [&](Random& random) {
      return exponential(config.multipath_for_s, random);
    };
    const auto offset_m = [&](Random& random) {
      const double towards_rad = random.uniform(-geometry::kPi, geometry::kPi);
      const double length_m = exponential(config.multipath_m, random);
      return Eigen::Vector2d(length_m *
                             Eigen::Vector2d(std::cos(towards_rad), std::sin(towards_rad)));
    };
    reflections_ = draw_episodes(seed, kReflections, between_s, length_s, offset_m);
  }
  if (config.wander_sd_m > 0.0) {
    Random random(seed, Stream::kGnssSky, kWander), upwards(seed, Stream::kGnssSky, kWanderUp);
    const double steps = std::min(kStepsMax, kDay_s * kStepsPerTime / config.wander_time_s);
    const double memory = std::exp(-kDay_s / steps / config.wander_time_s);
    const double fresh = std::sqrt(1.0 - memory * memory);
    Eigen::Vector3d now;
    now << random.normal(), random.normal(), upwards.normal();
    for (int i = 0; i <= static_cast<int>(steps); ++i) {
      wander_.push_back(now);
      const double east = random.normal(), north = random.normal();
      now = memory * now + fresh * Eigen::Vector3d(east, north, upwards.normal());
    }
  }
}

/// The episodes of a day, exponentially distributed between each other.
template <class Length, class Offset>
std::vector<ReceiverSky::Episode> ReceiverSky::draw_episodes(std::uint64_t seed, std::uint64_t part,
                                                             double between_s, Length length_s,
                                                             Offset offset_m) {
  Random random(seed, Stream::kGnssSky, part);
  std::vector<Episode> episodes;
  for (double time_s = exponential(between_s, random); time_s < kDay_s;) {
    const double end_s = time_s + length_s(random);
    episodes.push_back({time_s, end_s, offset_m(random)});
    time_s = end_s + exponential(between_s, random);
  }
  return episodes;
}

const ReceiverSky::Episode* ReceiverSky::at(const std::vector<Episode>& episodes, double time_s) {
  time_s = std::fmod(std::max(time_s, 0.0), kDay_s);
  const auto after =
      std::upper_bound(episodes.begin(), episodes.end(), time_s,
                       [](double time, const Episode& episode) { return time < episode.begin_s; });
  if (after == episodes.begin() || time_s >= std::prev(after)->end_s) return nullptr;
  return &*std::prev(after);
}

bool ReceiverSky::is_open(double time_s) const {
  return at(gaps_, time_s) == nullptr && at(pauses_, time_s) == nullptr;
}

bool ReceiverSky::is_reflected(double time_s) const { return at(reflections_, time_s) != nullptr; }

Eigen::Vector3d ReceiverSky::error_m(double time_s) const {
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  if (const Episode* reflection = at(reflections_, time_s)) {
    error.head<2>() += reflection->offset_m;
  }
  if (!wander_.empty()) {
    const double last = static_cast<double>(wander_.size() - 1);
    const double step = std::fmod(std::max(time_s, 0.0), kDay_s) / kDay_s * last;
    const auto before = static_cast<std::size_t>(std::min(step, last - 1.0));
    const double part = step - static_cast<double>(before);
    error += config_.wander_sd_m *
             Eigen::Vector3d(1.0, 1.0, 2.0)
                 .cwiseProduct((1.0 - part) * wander_[before] + part * wander_[before + 1]);
  }
  return error;
}

SatelliteReceiver::SatelliteReceiver(std::uint64_t seed, const SimulationConfig& config)
    : seed_(seed), config_(config.gnss), motion_(config.motion), sky_(seed, config.gnss.sky) {}

std::optional<pose::Gnss> SatelliteReceiver::fix(const DrivePath& path, std::int64_t index,
                                                 double time_s, const WheeledBody& body) const {
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
  const double sd_m = motion_.gnss_sd_m;
  const double stated_sd_m =
      config_.stated_sd_m > 0.0 ? config_.stated_sd_m : std::hypot(sd_m, sky_.wander_sd_m());
  if (const int jump = config_.jump.number_at(time_s); jump >= 0) {
    const double towards_rad = Random(seed_, Stream::kGnssJump, static_cast<std::uint64_t>(jump))
                                   .uniform(-geometry::kPi, geometry::kPi);
    x_m += config_.jump_m * std::cos(towards_rad);
    y_m += config_.jump_m * std::sin(towards_rad);
  }
  const Eigen::Vector3d sky_m = sky_.error_m(time_s);
  x_m += sky_m.x();
  y_m += sky_m.y();
  Random random(seed_, Stream::kGnss, static_cast<std::uint64_t>(index));
  const Eigen::Vector3d p_base_antenna_m(config_.antenna_m[0], config_.antenna_m[1], 0.0);
  const double z_m = (body.stand_at(T_map_base).transform() * p_base_antenna_m).z() + sky_m.z();
  return simulate_gnss(x_m, y_m, motion_.datum, sd_m, stated_sd_m, random, z_m);
}

}  // namespace orchard::simulation
