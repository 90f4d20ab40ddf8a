// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/fusion.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "geometry/statistics.hpp"
#include "pose/motion.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

// physical: the usual speed of such robots, which is unknown in a gap of ODOMETRY.
constexpr double kSilenceSpeedSd_mps = 1.5;
constexpr double kSilenceYawRateSd_radps = 0.5;
// physical: trunks of one row are a metre apart, so that a less certain position is warned of [m].
constexpr double kWarnSd_m = 0.5;
// derived: steps between fixes that show the receiver's noise are short against kReceiverMemory_s.
constexpr double kFixStep_s = 2.0;
// derived: the heading is known well enough for the solver of the smoothed path to converge.
constexpr double kStartYawSd_rad = 1.0 / 6.0;
// physical: an IMU speaks ten times in that time; wheels that turn less stand. A person reads a
// warning within five seconds.
constexpr double kImuFresh_s = 0.2;
constexpr double kStandingSpeed_mps = 1e-3;
constexpr double kStandingYawRate_radps = 1e-3;
constexpr double kNoteShown_s = 5.0;

}  // namespace

Eigen::Matrix3d fix_covariance(const PoseFix& fix, const PoseConfig& config) {
  const std::array<double, 6>& c = fix.covariance;
  Eigen::Matrix3d R;
  R << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  if (!(c[0] > 0.0 && c[3] > 0.0 && c[1] * c[1] < c[0] * c[3])) {
    R.setZero();
    R(0, 0) = R(1, 1) = geometry::square(config.fix_position_sd_m);
    R(2, 2) = c[5];
  }
  if (!(c[5] > 0.0)) {
    R.row(2).setZero();
    R.col(2).setZero();
    R(2, 2) = geometry::square(config.fix_yaw_sd_rad);
  }
  return R;
}

void Fixes::add(const Measurement& measurement) {
  const auto* fix = std::get_if<PoseFix>(&measurement);
  if (fix == nullptr) return;
  const Eigen::Matrix3d R = fix_covariance(*fix, config_);
  PoseEstimate pose =
      pose_estimate(fix->utime, {fix->x_m, fix->y_m, geometry::wrap_angle_rad(fix->yaw_rad)}, R);
  if (!fix->has_yaw) {
    if (!baseline_start_) baseline_start_ = *fix;
    const double dx_m = fix->x_m - baseline_start_->x_m;
    const double dy_m = fix->y_m - baseline_start_->y_m;
    const double way_m = std::hypot(dx_m, dy_m);
    if (way_m >= config_.heading_baseline_m) {
      baseline_start_ = *fix;
      pose.yaw_rad = std::atan2(dy_m, dx_m);
      pose.covariance[5] = (R(0, 0) + R(1, 1)) / geometry::square(way_m);
    } else if (estimate_) {
      pose.yaw_rad = estimate_->yaw_rad;
      pose.covariance[5] = estimate_->covariance[5];
    } else {
      return;
    }
    pose.covariance[2] = pose.covariance[4] = 0.0;
  }
  estimate_ = pose;
}

Fusion::Fusion(const PoseConfig& config)
    : config_(config),
      hypotheses_(config.fusion),
      local_(config.fusion),
      positions_(config.gnss),
      is_started_(!config.fusion.use_gnss && !config.fusion.use_fixes),
      is_placed_(is_started_) {
  if (!is_placed_ && config.mode == PoseMode::kFused) smoother_.emplace(config);
}

void Fusion::add(const Measurement& measurement) {
  const std::int64_t utime = utime_of(measurement);
  if (utime_ && utime < *utime_) return;
  if (const auto* odometry = std::get_if<Odometry>(&measurement)) add(*odometry);
  if (const auto* imu = std::get_if<Imu>(&measurement); imu && config_.fusion.use_imu) add(*imu);
  if (const auto* gnss = std::get_if<Gnss>(&measurement); gnss && config_.fusion.use_gnss) {
    add(*gnss);
  }
  if (const auto* fix = std::get_if<PoseFix>(&measurement); fix && config_.fusion.use_fixes) {
    add(*fix);
  }
  if (smoother_ && is_placed_) smoother_->tell(*utime_, path_pose());
}

void Fusion::add(const Odometry& odometry) {
  const double silent_s = time_since_motion_s(odometry.utime);
  if (silent_s > PoseConfig::kOdometryGapMax_s) {
    move_to(odometry.utime);
    ++num_odometry_gaps_;
    odometry_gap_max_s_ = std::max(odometry_gap_max_s_, silent_s);
    note(fmt::format("no ODOMETRY for {:.1f} s: the motion of the robot in that time is unknown",
                     silent_s));
  } else {
    odometry_ = odometry;
    move_to(odometry.utime, odometry.speed_mps, odometry.yaw_rate_radps);
  }
  odometry_ = odometry;
  if (smoother_) {
    smoother_->add(last_measured_motion(), path_pose());
    if (const auto pose = smoother_->observe(hypotheses_.best().histories.likeliest())) {
      // With an IMU the turns come from the gyro and do not show the wheels' errors.
      const auto changes = smoother_->wheel_error_noise();
      for (FixHypotheses::Hypothesis& h : hypotheses_.all()) {
        if (changes && !config_.fusion.use_imu) h.filter.set_wheel_error_noise(*changes);
      }
      if (!is_displaced()) {
        hypotheses_.all().front().filter.set_smoothed_pose(pose->T_map_base, pose->covariance,
                                                           pose->receiver_error_m);
      }
    }
  }
  const bool stands = std::abs(odometry.speed_mps) < kStandingSpeed_mps &&
                      std::abs(odometry.yaw_rate_radps) < kStandingYawRate_radps;
  if (stands && has_gyro_at(odometry.utime)) {
    const double sd_radps = std::max(config_.fusion.gyro_sd_radps, 1e-4);
    for (FixHypotheses::Hypothesis& h : hypotheses_.all()) {
      h.filter.correct_gyro_bias(imu_->angular_rate_radps[2], geometry::square(sd_radps));
    }
  }
}

void Fusion::add(const Imu& imu) {
  move_to(imu.utime);
  imu_ = imu;
}

void Fusion::add(const Gnss& gnss) {
  if (odometry_) move_to(gnss.utime);
  const std::optional<GnssPosition> position = positions_.add(gnss);
  if (!position) return;
  const bool is_frozen = monitor_.is_frozen_at(gnss, travel_m_);
  travel_m_ = 0.0;
  if (is_frozen) {
    ++num_frozen_;
    note("GNSS is frozen: it repeats the same fix while the robot moves");
    return;
  }
  PositionObservation observation;
  observation.p_map_m = position->p_enu_m;
  observation.covariance = position->covariance;
  observation.p_base_m = {config_.gnss.antenna_m[0], config_.gnss.antenna_m[1]};
  observation.is_gnss = true;
  const Eigen::Vector2d antenna_m = filter().p_map_m(observation.p_base_m);
  if (last_fix_ && is_placed_ && timing::seconds(gnss.utime - last_fix_->utime) <= kFixStep_s) {
    monitor_.add_step_error((observation.p_map_m - last_fix_->p_map_m) -
                            (antenna_m - last_fix_->antenna_m));
  }
  set_receiver_noise(observation);
  if (odometry_) {
    use_position(observation);
    observation.covariance = position->covariance;  // the smoother weighs positions by itself
    smooth(observation);
  }
  last_fix_ = LastFix{gnss.utime, observation.p_map_m, filter().p_map_m(observation.p_base_m)};
}

/// Splits the variance of a fix into white noise and a time-correlated error, by the scatter of the
/// receiver's steps.
void Fusion::set_receiver_noise(PositionObservation& observation) {
  const double claimed = observation.covariance.diagonal().maxCoeff();
  const std::optional<double> scatter_m = monitor_.scatter_m();
  const auto set_lasting = [this](double variance) {
    for (FixHypotheses::Hypothesis& h : hypotheses_.all()) h.filter.set_receiver_variance(variance);
  };
  if (!scatter_m) {
    set_lasting(claimed);
    return;
  }
  const double scatter = geometry::square(*scatter_m);
  if (scatter > 4.0 * claimed) {
    observation.covariance = scatter * Eigen::Matrix2d::Identity();
    note(fmt::format("GNSS scatters by {:.2f} m, more than it states: it gets less weight",
                     *scatter_m));
  }
  // The scatter is known to a few tenths only: count as correlated only what exceeds twice its
  // variance.
  const double lasting = std::max(0.0, claimed - 2.0 * scatter);
  observation.covariance *= 1.0 - lasting / claimed;
  set_lasting(lasting);
}

void Fusion::use_position(const PositionObservation& observation) {
  if (!is_started_) {
    is_started_ = true;
    first_local_m_ = local_.p_map_m(observation.p_base_m);
    hypotheses_.start(observation, *utime_);
    return;
  }
  const double claimed =
      observation.covariance.diagonal().maxCoeff() + filter().receiver_variance();
  hypotheses_.split_unknown_headings(claimed);
  hypotheses_.correct(observation, *utime_);
  if (!is_placed_) start(observation);
  if (!is_placed_ || !is_displaced()) return;
  const DisplacedTime& displaced = hypotheses_.best().histories.likeliest().back();
  note(fmt::format("{} {:.1f} m from any possible position of the robot: ignored for {:.1f} s",
                   displaced.is_gnss ? "GNSS is" : "POSE_FIX is", filter().off_m(observation),
                   timing::seconds(*utime_ - displaced.begin_utime)));
}

/// Begins to tell poses once the positions give the heading.
void Fusion::start(const PositionObservation& observation) {
  const Eigen::Vector3d local = local_.mean().head<3>();
  const double moved_m = (local_.p_map_m(observation.p_base_m) - *first_local_m_).norm();
  const double yaw_variance = hypotheses_.estimate(*utime_).covariance[5];
  if (moved_m < config_.heading_baseline_m || yaw_variance > geometry::square(kStartYawSd_rad)) {
    return;
  }
  is_placed_ = true;
  if (smoother_) {
    smoother_->place(geometry::compose(filter().mean().head<3>(),
                                       geometry::between(local, Eigen::Vector3d::Zero())));
  }
  go_back();
}

void Fusion::place(const Eigen::Vector3d& x_y_yaw, const Eigen::Matrix3d& covariance,
                   bool is_gnss) {
  if (smoother_) {
    smoother_->place(
        geometry::compose(x_y_yaw, geometry::between(path_pose(), Eigen::Vector3d::Zero())));
  }
  hypotheses_.place(x_y_yaw, covariance, utime_.value_or(0), is_gnss);
  is_started_ = is_placed_ = true;
  go_back();
}

/// Computes the poses before the first known one from the steps that led to it.
void Fusion::go_back() {
  FixHypotheses back = hypotheses_;
  for (; !unplaced_.empty(); unplaced_.pop_back()) {
    auto [utime, step] = unplaced_.back();
    step.dt_s = -step.dt_s;
    back.move(step);
    if (utime < *utime_) past_.push_back(back.estimate(utime));
  }
  std::reverse(past_.begin(), past_.end());
}

/// Returns the pose for the smoothed path, dead-reckoned before the pose in map is known.
Eigen::Vector3d Fusion::path_pose() const {
  return (is_placed_ ? filter() : local_).mean().head<3>();
}

void Fusion::move(const MotionStep& step) {
  hypotheses_.move(step);
  if (is_placed_) return;
  local_.move(step);
  if (step.dt_s <= 0.0) return;
  unplaced_.push_back({*utime_, step});
  while (*utime_ - unplaced_.front().utime > kPastMax_us) unplaced_.pop_front();
}

void Fusion::smooth(const PositionObservation& observation, std::optional<double> yaw_rad,
                    double yaw_sd_rad) {
  if (!smoother_) return;
  AbsolutePosition position;
  position.lever_base_m = observation.p_base_m;
  position.p_map = observation.p_map_m;
  position.covariance = observation.covariance;
  position.is_gnss = observation.is_gnss;
  position.has_yaw = yaw_rad.has_value();
  position.yaw_rad = yaw_rad.value_or(0.0);
  position.yaw_sd_rad = yaw_sd_rad;
  smoother_->add(*utime_, position, path_pose());
}

/// Returns the last odometry, with the gyro's yaw rate if it is fresh.
Odometry Fusion::last_measured_motion() const {
  Odometry heard = *odometry_;
  if (!has_gyro_at(heard.utime)) return heard;
  if (heard.covariance[0] <= 0.0)
    heard.covariance[0] = geometry::square(config_.speed_sd_fraction * heard.speed_mps);
  heard.yaw_rate_radps = imu_->angular_rate_radps[2];
  heard.covariance[1] = 0.0;
  heard.covariance[2] = imu_->angular_rate_variance > 0.0
                            ? imu_->angular_rate_variance
                            : geometry::square(config_.fusion.gyro_sd_radps);
  return heard;
}

std::optional<Trajectory> Fusion::take_correction() {
  return smoother_ ? smoother_->take_correction() : std::nullopt;
}

void Fusion::finish() {
  is_finished_ = true;
  if (smoother_) smoother_->finish(hypotheses_.histories());
}

void Fusion::add(const PoseFix& fix) {
  if (odometry_) move_to(fix.utime);
  PositionObservation observation;
  observation.p_map_m = {fix.x_m, fix.y_m};
  const Eigen::Matrix3d covariance = fix_covariance(fix, config_);
  observation.covariance = covariance.topLeftCorner<2, 2>();
  const double yaw_variance = covariance(2, 2);
  if ((!is_placed_ || !odometry_) && fix.has_yaw) {
    utime_ = fix.utime;
    place({fix.x_m, fix.y_m, fix.yaw_rad}, covariance, false);
    return;
  }
  if (!odometry_) return;
  use_position(observation);
  smooth(observation, fix.has_yaw ? std::optional(fix.yaw_rad) : std::nullopt,
         std::sqrt(yaw_variance));
  for (FixHypotheses::Hypothesis& h : hypotheses_.all()) {
    if (is_placed_ && fix.has_yaw) h.filter.correct_yaw(fix.yaw_rad, yaw_variance);
  }
}

bool Fusion::has_gyro_at(std::int64_t utime) const {
  return imu_ && timing::seconds(utime - imu_->utime) <= kImuFresh_s;
}

double Fusion::time_since_motion_s(std::int64_t utime) const {
  return odometry_ ? timing::seconds(utime - odometry_->utime) : 0.0;
}

void Fusion::move_to(std::int64_t utime) {
  if (!odometry_) {
    if (!utime_) utime_ = utime;
    return;
  }
  const double silent_s = time_since_motion_s(utime);
  if (silent_s <= PoseConfig::kOdometryGapMax_s) {
    move_to(utime, odometry_->speed_mps, odometry_->yaw_rate_radps);
    return;
  }
  // Model: constant but unknown velocity since the last odometry.
  const double before_s = std::max(0.0, time_since_motion_s(*utime_));
  const double grown = geometry::square(silent_s) - geometry::square(before_s);
  const double yaw_variance =
      has_gyro_at(utime) ? 0.0 : geometry::square(kSilenceYawRateSd_radps) * grown;
  for (FixHypotheses::Hypothesis& h : hypotheses_.all()) {
    h.filter.inflate_covariance(geometry::square(kSilenceSpeedSd_mps) * grown, yaw_variance);
  }
  if (has_gyro_at(utime)) {
    MotionStep turn;
    turn.dt_s = timing::seconds(utime - *utime_);
    turn.yaw_rate_radps = imu_->angular_rate_radps[2];
    turn.yaw_rate_sd_radps = config_.fusion.gyro_sd_radps;
    turn.is_gyro = true;
    move(turn);
  }
  unplaced_.clear();
  note(fmt::format("no ODOMETRY for {:.1f} s: the motion of the robot is unknown", silent_s));
  utime_ = utime;
}

void Fusion::move_to(std::int64_t utime, double speed_mps, double yaw_rate_radps) {
  if (!utime_) utime_ = utime;
  MotionStep step;
  step.dt_s = timing::seconds(utime - *utime_);
  step.speed_mps = speed_mps;
  const auto& covariance = odometry_ ? odometry_->covariance : std::array<double, 3>{};
  const bool states_covariance = covariance[0] > 0.0 || covariance[2] > 0.0;
  step.speed_sd_mps = states_covariance ? std::sqrt(covariance[0])
                                        : config_.speed_sd_fraction * std::abs(speed_mps);
  step.is_gyro = has_gyro_at(utime);
  if (step.is_gyro) {
    step.yaw_rate_radps = imu_->angular_rate_radps[2];
    step.yaw_rate_sd_radps = imu_->angular_rate_variance > 0.0
                                 ? std::sqrt(imu_->angular_rate_variance)
                                 : config_.fusion.gyro_sd_radps;
  } else {
    step.yaw_rate_radps = yaw_rate_radps;
    step.yaw_rate_sd_radps =
        states_covariance ? std::sqrt(covariance[2]) : config_.yaw_rate_sd_radps;
  }
  move(step);
  travel_m_ += std::abs(speed_mps) * step.dt_s;
  utime_ = utime;
}

std::optional<PoseEstimate> Fusion::estimate() const {
  if (!is_placed_ || !utime_) return std::nullopt;
  if (!filter().mean().allFinite() || !filter().covariance().allFinite()) return std::nullopt;
  return hypotheses_.estimate(*utime_);
}

void Fusion::note(std::string text) {
  note_ = std::move(text);
  note_utime_ = utime_.value_or(0);
}

std::vector<Finding> Fusion::findings() const {
  std::vector<Finding> findings;
  if (!is_finished_) return findings;
  if (!is_placed_) {
    findings.push_back({"never_located", "pose.mode",
                        "the start was never located: no heading from GNSS or POSE_FIX"});
  }
  if (!smoother_) return findings;
  if (smoother_->is_doubtful()) {
    findings.push_back({"positions_contradict", "pose.fusion",
                        "the positions contradict each other or the wheels: the path may be wrong "
                        "by far more than it says"});
  }
  if (smoother_->open_sd_m() > 0.0) {
    findings.push_back(
        {"fixes_ambiguous", "pose.fusion",
         fmt::format("it is open which positions were displaced, e.g. by reflected signals: the "
                     "path is the mean of several, {:.1f} m apart (one sigma) where they differ "
                     "most",
                     smoother_->open_sd_m())});
  }
  if (std::string left_out = rejected_fixes_text(smoother_->left_out()); !left_out.empty()) {
    findings.push_back({"fixes_left_out", "pose.fusion", std::move(left_out)});
  }
  return findings;
}

std::string Fusion::warning() const {
  if (is_finished_) {
    std::string all;
    if (num_frozen_ > 0)
      all += fmt::format("{} GNSS fixes of a frozen receiver were ignored; ", num_frozen_);
    if (num_odometry_gaps_ > 0) {
      all += fmt::format("ODOMETRY silent {} times, up to {:.1f} s; ", num_odometry_gaps_,
                         odometry_gap_max_s_);
    }
    if (!all.empty()) all.resize(all.size() - 2);
    return all;
  }
  if (utime_ && !note_.empty() && timing::seconds(*utime_ - note_utime_) < kNoteShown_s)
    return note_;
  if (!is_placed_ && utime_) {
    return "no pose yet: the robot must drive a distance before GNSS or POSE_FIX give a heading";
  }
  const double worst_variance = filter().covariance().diagonal().head<2>().maxCoeff();
  if (is_placed_ && worst_variance > geometry::square(kWarnSd_m)) {
    return fmt::format("the position is uncertain: {:.2f} m (one sigma)",
                       std::sqrt(worst_variance));
  }
  return {};
}

}  // namespace orchard::pose
