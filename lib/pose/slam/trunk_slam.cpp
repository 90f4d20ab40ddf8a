// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/trunk_slam.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "geometry/pose2.hpp"
#include "pose/filter/fix_hypotheses.hpp"
#include "pose/graph/calibration.hpp"
#include "pose/graph/georeference.hpp"
#include "pose/motion.hpp"
#include "timing/units.hpp"

namespace orchard::pose {

using geometry::between;
using geometry::compose;
namespace {

// derived: a keyframe for a turn that changes the view like half a metre of travel, and for a
// motion that has become as uncertain as a landmark's gate bears; none while the robot stands.
// Without scans they are sparser; they still record the path.
constexpr double kKeyframeTurn_rad = 0.3;
constexpr double kKeyframeSd_m = 0.05;
constexpr double kKeyframeSd_rad = 0.02;
constexpr std::int64_t kBlindKeyframe_us = 200'000;
constexpr double kMovingTravel_m = 0.02;
constexpr double kBlindFactor = 3.0;

// derived: the whole graph is solved when it has grown by a tenth, so that the cost per keyframe
// stays constant; two landmarks give a velocity; LOST and AMBIGUOUS are told at the end above a
// tenth of the drive; scans are put in order within a second.
constexpr double kSolveGrowth = 0.1;
constexpr int kSolveKeyframesMin = 20;
constexpr int kVelocityLandmarks = 2;
constexpr int kWorthSaying = 10;
constexpr std::int64_t kScanOrder_us = 1'000'000;

// physical: how well a person or a total station marks a place [m].
constexpr double kPlacementSdMin_m = 0.02;

}  // namespace

TrunkSlam::TrunkSlam(const PoseConfig& config, const laser::LaserConfig& mount,
                     const laser::BlindSector& blind, std::shared_ptr<ChunkAllocator> memory)
    : pose_config_(config),
      config_(config.slam),
      mount_(mount),
      blind_(blind),
      gnss_(config.gnss),
      motion_(config_),
      map_(config_, memory),
      tracker_(config_),
      closer_(config_),
      scan_loop_closer_(config.scan_motion, mount, std::move(memory)) {
  if (reads_scans(config)) scan_motion_.emplace(config, mount, blind);
  motion_.set_default_noise(config.speed_sd_fraction, config.yaw_rate_sd_radps);
}

void TrunkSlam::add(const Measurement& measurement) {
  if (const auto* odometry = std::get_if<Odometry>(&measurement)) {
    if (scan_motion_) {
      scan_motion_->add(*odometry);
      return;
    }
    motion_.add(*odometry);
    add_blind_keyframe();
  } else if (const auto* scan = std::get_if<laser::Scan>(&measurement)) {
    scan_ = *scan;
    if (!scan_motion_) return;
    const auto motion = scan_motion_->add(*scan);
    next_scan_tells_ = motion && !motion->reliable && motion->matched > 0.0;
    if (motion && !motion->has_place) {
      const double dt_s = timing::seconds(motion->utime_to - motion->utime_from);
      motion_.set_velocity(motion->T_from_to.x() / dt_s, motion->T_from_to.z() / dt_s);
      motion_.advance_to(motion->utime_to);
    } else if (motion) {
      motion_.add(motion->utime_to, motion->T_from_to, motion->covariance_calibrated,
                  motion->is_guess, motion->calibration_jacobian);
      add_blind_keyframe();
    }
  } else if (const auto* seen = std::get_if<detection::Detections>(&measurement)) {
    add(*seen);
  } else if (const auto* fix = std::get_if<PoseFix>(&measurement)) {
    if (config_.use_fixes) add(*fix);
  } else if (const auto* gnss = std::get_if<Gnss>(&measurement)) {
    if (config_.use_gnss) add(*gnss);
  }
  tell();
}

void TrunkSlam::tell() {
  if (map_.empty()) return;
  const Eigen::Vector3d delta = motion_.motion().delta_with(map_.newest_calibration());
  told_.tell({motion_.utime(), map_.newest(), delta},
             compose(map_.graph.keyframes.back().T_map_base, delta), map_.graph);
}

/// Returns the covariance of the motion since the keyframe, including that of the odometry
/// calibration.
Eigen::Matrix3d TrunkSlam::motion_covariance() const {
  const RelativeMotion& m = motion_.motion();
  const int interval = static_cast<int>(map_.graph.calibrations.size()) - 1;
  return m.covariance + m.calibration_jacobian * map_.calibration_at(interval).covariance *
                            m.calibration_jacobian.transpose();
}

void TrunkSlam::add_blind_keyframe() {
  if (!map_.empty() && wants_keyframe(kBlindFactor)) add_keyframe();
}

void TrunkSlam::add_position(std::int64_t utime, AbsolutePosition position) {
  if (!position.p_map.allFinite() || !position.covariance.allFinite() ||
      !position.lever_base_m.allFinite() || !std::isfinite(position.yaw_rad) ||
      position.covariance.determinant() <= 0.0) {
    return;
  }
  motion_.advance_to(utime);
  if (map_.empty() || wants_keyframe(kBlindFactor)) add_keyframe();
  // GnssPositions already enforces a minimum for a receiver.
  if (!position.is_gnss) {
    position.covariance += kPlacementSdMin_m * kPlacementSdMin_m * Eigen::Matrix2d::Identity();
  }
  position.utime = utime;
  position.T_keyframe_then = motion_.motion().delta_with(map_.newest_calibration());
  pose::add_position(position, map_.graph);
  map_.process_absolute_position();
}

bool TrunkSlam::wants_keyframe(double factor) const {
  const RelativeMotion& m = motion_.motion();
  const std::int64_t since_us = motion_.utime() - map_.graph.keyframes.back().utime;
  if (since_us <= 0) return false;
  // A fix tells at once where base is, and belongs to the keyframe before it.
  if (next_scan_tells_ && !config_.use_fixes &&
      m.travel_m < kBlindFactor * config_.keyframe_travel_m) {
    return false;
  }
  const double sd_m = std::sqrt(std::max(m.covariance(0, 0), m.covariance(1, 1)));
  const double sd_rad = std::sqrt(m.covariance(2, 2));
  const bool unsure = sd_m > factor * kKeyframeSd_m || sd_rad > factor * kKeyframeSd_rad;
  const bool blind = motion_.time_since_motion_s() > config_.gap_s && since_us >= kBlindKeyframe_us;
  return m.travel_m >= factor * config_.keyframe_travel_m ||
         std::abs(m.delta.z()) >= factor * kKeyframeTurn_rad ||
         (unsure && (m.travel_m > kMovingTravel_m || blind));
}

void TrunkSlam::add(const detection::Detections& seen) {
  if (motion_.started() && seen.utime < motion_.utime() &&
      motion_.utime() - seen.utime > kScanOrder_us) {
    return;  // far too old; the caller's queue normally excludes this
  }
  motion_.advance_to(seen.utime);
  const bool added = map_.empty() || wants_keyframe(1.0);
  if (added) add_keyframe();
  const bool has_scan = added && scan_ && scan_->utime == seen.utime;
  if (has_scan) {
    scan_loop_closer_.keep(
        surface_points(*scan_, mount_, blind_, velocity(), pose_config_.scan_motion), map_);
  }
  const OdometryCalibration& c = map_.newest_calibration();
  const Eigen::Vector2d velocity = motion_.velocity_with(c);
  const ScanMotionState state{motion_.motion().delta_with(c), motion_covariance(), velocity.x(),
                              velocity.y()};
  tracker_.match(scan_points(seen, state, map_.graph.observation_noise, config_), map_);
  if (added) correct();
  if (has_scan && scan_loop_closer_.observe(map_)) tracker_.correct_window(map_);
  watch(seen.utime);
}

void TrunkSlam::add_keyframe() {
  Keyframe keyframe;
  keyframe.utime = motion_.utime();
  SlamGraph& graph = map_.graph;
  if (!map_.empty()) {
    tracker_.finish_keyframe(map_);
    const Keyframe& before = graph.keyframes.back();
    const OdometryCalibration calibration = map_.newest_calibration();
    keyframe.motion = motion_.motion();
    keyframe.travel_m = before.travel_m + keyframe.motion.travel_m;
    const auto interval = [&](double travel_m) {
      return static_cast<int>(travel_m / kCalibrationTravel_m);
    };
    if (interval(keyframe.travel_m) > interval(before.travel_m)) {
      graph.calibrations.push_back(
          calibration_decay(graph.calibration_walk_sd, config_).cwiseProduct(calibration));
    }
    keyframe.calibration = static_cast<int>(graph.calibrations.size()) - 1;
    const Eigen::Vector3d delta = keyframe.motion.delta_with(calibration);
    const Eigen::Matrix3d Q = motion_covariance();
    keyframe.T_map_base = compose(before.T_map_base, delta);
    JointCovariance P =
        after_motion(joint_covariance(before), before.T_map_base, keyframe.motion, delta);
    if (keyframe.calibration > before.calibration) {
      const Eigen::Vector3d kept = calibration_decay(graph.calibration_walk_sd, config_);
      P.rightCols<3>() *= kept.asDiagonal();
      P.bottomRows<3>() = (kept.asDiagonal() * P.bottomRows<3>()).eval();
      P.diagonal().tail<3>() += graph.calibration_walk_sd.array().square().matrix();
    }
    set_joint_covariance(P, keyframe);
    keyframe.local_covariance =
        compose_covariance(before.T_map_base, before.local_covariance, delta, Q);
  }
  if (map_.empty()) keyframe.calibration_covariance = map_.calibration_at(0).covariance;
  graph.keyframes.push_back(std::move(keyframe));
  motion_.restart(map_.newest_calibration());
  map_.archive_old_observations();
  tracker_.start_keyframe(map_);
}

/// Corrects the last keyframes; corrects all at a loop closure or when the graph has grown.
void TrunkSlam::correct() {
  if (!tracker_.correct_window(map_)) return;
  const std::vector<Keyframe>& keyframes = map_.graph.keyframes;
  if (motion_.time_since_motion_s() > config_.gap_s &&
      tracker_.num_matched() >= kVelocityLandmarks) {
    const Keyframe& a = keyframes[keyframes.size() - 2];
    const Keyframe& b = keyframes.back();
    const double dt_s = (b.utime - a.utime) * 1e-6;
    const Eigen::Vector3d moved = between(a.T_map_base, b.T_map_base);
    if (dt_s > 0.0) motion_.set_velocity(moved.x() / dt_s, moved.z() / dt_s);
  }
  closer_.observe(map_);
  const double solve_at = map_.num_solved * (1.0 + kSolveGrowth) + kSolveKeyframesMin;
  if (static_cast<double>(keyframes.size()) >= solve_at) map_.solve(SolveReason::kGrowth);
}

void TrunkSlam::watch(std::int64_t utime) {
  if (scan_utime_ > 0 && utime > scan_utime_) {
    const std::int64_t since_us = std::min(utime - scan_utime_, kScanOrder_us);
    driven_us_ += since_us;
    if (map_.lost) lost_us_ += since_us;
    if (tracker_.is_ambiguous() || closer_.is_ambiguous()) ambiguous_us_ += since_us;
  }
  scan_utime_ = utime;
}

double TrunkSlam::end_sd_m() const {
  const Eigen::Matrix3d& P = map_.graph.keyframes.back().covariance;
  return std::sqrt(std::max(P(0, 0), P(1, 1)));
}

std::vector<std::pair<std::string, std::int64_t>> TrunkSlam::statistics() const {
  constexpr std::int64_t kSecond_us = 1'000'000;  // physical: of an SI second
  if (map_.empty()) return {};
  return {{"loops_asked", closer_.counts().num_searches},
          {"loops_closed", num_closures()},
          {"loops_refused", num_refuted_closures()},
          {"lost_s", lost_us_ / kSecond_us},
          {"ambiguous_s", ambiguous_us_ / kSecond_us},
          {"end_sd_mm", std::llround(std::min(end_sd_m(), 1e6) * 1e3)}};
}

void TrunkSlam::finish() {
  finished_ = true;
  if (map_.empty()) return;
  if (motion_.utime() > map_.graph.keyframes.back().utime) add_keyframe();
  closer_.close(map_);
  mark_displaced_fixes(map_.graph);
  map_.solve(SolveReason::kEndOfDrive);
  closer_.merge_duplicate_landmarks(map_);
  if (scan_loop_closer_.drop_contradicted(map_)) map_.solve(SolveReason::kEndOfDrive);
  told_.end(map_.graph);
  rejected_text_ = rejected_fixes_text(rejected_fixes(map_.graph));
  const RejectedFixes off = rejected_fixes(map_.graph, false);
  if (kWorthSaying * off.num_left_out > off.num_fixes) off_text_ = rejected_fixes_text(off, false);
  receiver_text_ = receiver_text(map_.graph);
}

std::optional<PoseEstimate> TrunkSlam::estimate() const {
  if (map_.empty()) return std::nullopt;
  const Keyframe& keyframe = map_.graph.keyframes.back();
  const Eigen::Vector3d delta = motion_.motion().delta_with(map_.newest_calibration());
  const Eigen::Vector3d T = compose(keyframe.T_map_base, delta);
  const Eigen::Matrix3d P =
      compose_covariance(keyframe.T_map_base, keyframe.covariance, delta, motion_covariance());
  if (!T.allFinite() || !P.allFinite()) return std::nullopt;
  return pose_estimate(motion_.utime(), T, P);
}

std::optional<Trajectory> TrunkSlam::take_correction() {
  if (!map_.corrected) return std::nullopt;
  map_.corrected = false;
  Trajectory trajectory;
  trajectory.utime = motion_.utime();
  trajectory.revision = ++revision_;
  trajectory.poses = told_.key_poses(map_.graph);
  told_.correct(map_.graph);
  return trajectory;
}

std::string TrunkSlam::warning() const {
  if (map_.empty()) return {};
  if (motion_.time_since_motion_s() > config_.gap_s) {
    return "no motion measured for " +
           std::to_string(static_cast<int>(motion_.time_since_motion_s())) +
           " s: the pose is extrapolated with the last velocity";
  }
  if (tracker_.is_ambiguous()) return "AMBIGUOUS: the trunks in view fit several places";
  if (closer_.is_ambiguous()) {
    return "AMBIGUOUS: the last trunks fit the map in several ways; no loop is closed";
  }
  if (map_.lost && !map_.is_session_georeferenced()) {
    return "LOST: the trunks in view did not fit the map for too long; a separate map is built "
           "until a loop closes";
  }
  return {};
}

std::vector<Finding> TrunkSlam::findings() const {
  std::vector<Finding> findings;
  if (!finished_ || map_.empty()) return findings;
  if (kWorthSaying * (lost_us_ + ambiguous_us_) > driven_us_) {
    findings.push_back({"lost_place", "pose.slam",
                        "LOST for " + std::to_string(lost_us_ / 1'000'000) +
                            " s and AMBIGUOUS for " + std::to_string(ambiguous_us_ / 1'000'000) +
                            " s of " + std::to_string(driven_us_ / 1'000'000) +
                            " s of the drive: check the map before using it"});
  }
  if (end_sd_m() > config_.lost_sd_m) {
    const bool has_loops = num_closures() > 0;
    findings.push_back(
        {has_loops ? "uncertain_end" : "no_loop_closed", "pose.slam",
         "the position at the end of the drive is uncertain: " +
             std::to_string(std::lround(end_sd_m() * 100)) + " cm (one sigma), " +
             (has_loops ? "long after the last closed loop" : "because no loop was closed") +
             "; drive past known trees again"});
  }
  if (!rejected_text_.empty()) findings.push_back({"fixes_left_out", "pose.gnss", rejected_text_});
  if (!off_text_.empty()) {
    findings.push_back({"path_contradicts_fixes", "pose.fix_position_sd_m",
                        off_text_ +
                            ": trees were mistaken for one another there, or these fixes err "
                            "more than they or pose.fix_position_sd_m state"});
  }
  if (!receiver_text_.empty()) findings.push_back({"receiver_noise", "pose.gnss", receiver_text_});
  return findings;
}

void TrunkSlam::add(const PoseFix& fix) {
  AbsolutePosition position;
  position.p_map = {fix.x_m, fix.y_m};
  position.covariance << fix.covariance[0], fix.covariance[1], fix.covariance[1], fix.covariance[3];
  if (fix.covariance[0] <= 0.0 || fix.covariance[3] <= 0.0) {
    position.covariance = pose_config_.fix_position_sd_m * pose_config_.fix_position_sd_m *
                          Eigen::Matrix2d::Identity();
  }
  position.has_yaw = fix.has_yaw;
  position.yaw_rad = fix.yaw_rad;
  position.yaw_sd_rad =
      fix.covariance[5] > 0.0 ? std::sqrt(fix.covariance[5]) : pose_config_.fix_yaw_sd_rad;
  add_position(fix.utime, position);
}

void TrunkSlam::add(const Gnss& gnss) {
  const std::optional<GnssPosition> gnss_position = gnss_.add(gnss);
  if (!gnss_position) return;
  AbsolutePosition position;
  position.lever_base_m = {pose_config_.gnss.antenna_m[0], pose_config_.gnss.antenna_m[1]};
  position.p_map = gnss_position->p_enu_m;
  position.covariance = gnss_position->covariance;
  position.is_gnss = true;
  add_position(gnss.utime, position);
}

}  // namespace orchard::pose
