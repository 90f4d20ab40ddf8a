// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/trunk_slam.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "pose/planar.hpp"
#include "pose/slam/local_map.hpp"
#include "pose/slam/map_placement.hpp"
#include "pose/slam/scan_points.hpp"
#include "pose/slam/submaps.hpp"

namespace orchard::pose {
namespace {

// A keyframe also where the motion since the last has become this uncertain.
constexpr double kKeyframeSdM = 0.05;
constexpr double kKeyframeSdRad = 0.02;
constexpr std::int64_t kBlindKeyframeUs = 200'000;  // nor more often where nothing tells the motion
constexpr int kSolveMinKeyframes = 20;
// Less surely placed than this, what matches nothing is the beginning of a map of its own.
constexpr double kAnewSdM = 0.25;
constexpr int kAmbiguousScans = 10;
constexpr int kContradictedScans = 10;

}  // namespace

TrunkSlam::TrunkSlam(const SlamConfig& config) : config_(config), motion_(config) {
  map_.calibration.covariance = initial_errors_sd(config).array().square().matrix().asDiagonal();
  map_.graph.calibrations.push_back(map_.calibration.mean);
}

void TrunkSlam::set_default_noise(double speed_sd_fraction, double yaw_rate_sd_radps) {
  motion_.set_default_noise(speed_sd_fraction, yaw_rate_sd_radps);
}

WheelErrors TrunkSlam::current_errors() const { return map_.graph.calibrations.back(); }

/// Of the motion since the keyframe, the wheels' errors included.
Eigen::Matrix3d TrunkSlam::motion_covariance() const {
  const RelativeMotion& m = motion_.motion();
  return m.covariance +
         m.error_jacobian * map_.calibration.covariance * m.error_jacobian.transpose();
}

void TrunkSlam::add(const Odometry& odometry) {
  motion_.add(odometry);
  // without scans the path still has to be told
  if (!map_.graph.keyframes.empty() && wants_keyframe(3.0)) open_keyframe();
}

void TrunkSlam::add_motion(std::int64_t utime, const Eigen::Vector3d& T_before_now,
                           const Eigen::Matrix3d& covariance) {
  motion_.add(utime, T_before_now, covariance);
  if (!map_.graph.keyframes.empty() && wants_keyframe(3.0)) open_keyframe();
}

void TrunkSlam::add_fix(std::int64_t utime, PlaceFix fix) {
  if (!fix.p_map.allFinite() || !fix.covariance.allFinite() || !fix.lever_base_m.allFinite() ||
      !std::isfinite(fix.yaw_rad) || fix.covariance.determinant() <= 0.0) {
    return;
  }
  motion_.advance_to(utime);
  if (map_.graph.keyframes.empty() || wants_keyframe(3.0)) open_keyframe();
  fix.covariance += config_.place_sd_min_m * config_.place_sd_min_m * Eigen::Matrix2d::Identity();
  fix.T_keyframe_then = motion_.motion().delta_with(current_errors());
  map_.graph.keyframes.back().fixes.push_back(fix);
  if (!map_.graph.placed) place_in_map();
}

void TrunkSlam::place_in_map() {
  const std::optional<Eigen::Vector3d> T_map_graph = placement(map_.graph, config_.place_travel_m);
  if (!T_map_graph) return;
  place(map_.graph, *T_map_graph);
  if (map_.graph.keyframes.size() > 1 && solve_all(WholeReason::kGrown)) return;
  // the whole solve's covariance will follow; until then that of the fix
  for (Keyframe& k : map_.graph.keyframes) {
    for (const PlaceFix& fix : k.fixes) {
      k.covariance.topLeftCorner<2, 2>() = fix.covariance;
      k.covariance(2, 2) = fix.yaw_sd_rad * fix.yaw_sd_rad;
    }
  }
  rebuild_index();
}

bool TrunkSlam::wants_keyframe(double factor) const {
  const RelativeMotion& m = motion_.motion();
  const std::int64_t since_us = motion_.utime() - map_.graph.keyframes.back().utime;
  if (since_us <= 0) return false;
  const double sd_m = std::sqrt(std::max(m.covariance(0, 0), m.covariance(1, 1)));
  const double sd_rad = std::sqrt(m.covariance(2, 2));
  const bool unsure = sd_m > factor * kKeyframeSdM || sd_rad > factor * kKeyframeSdRad;
  const bool blind = motion_.silence_s() > config_.gap_s && since_us >= kBlindKeyframeUs;
  return m.travel_m >= factor * config_.keyframe_travel_m ||
         std::abs(m.delta.z()) >= factor * config_.keyframe_turn_rad ||
         (unsure && (m.travel_m > 0.02 || blind));
}

void TrunkSlam::add(const SeenTrunks& seen) {
  if (motion_.started() && seen.utime < motion_.utime() &&
      motion_.utime() - seen.utime > 1'000'000) {
    return;  // from another time: the queue before us lets none through
  }
  motion_.advance_to(seen.utime);
  const bool opened = map_.graph.keyframes.empty() || wants_keyframe(1.0);
  if (opened) open_keyframe();
  const WheelErrors e = current_errors();
  const RelativeMotion& m = motion_.motion();
  const ScanMotionState state{m.delta_with(e), motion_covariance(),
                              (1.0 + e[0]) * motion_.speed_mps(),
                              (1.0 + e[1]) * motion_.yaw_rate_radps() - e[2]};
  ++num_scans_;
  match(scan_points(seen, state, config_));
  if (opened) correct_window();
}

void TrunkSlam::open_keyframe() {
  Keyframe keyframe;
  keyframe.utime = motion_.utime();
  if (!map_.graph.keyframes.empty()) {
    review_landmarks();
    const Keyframe& before = map_.graph.keyframes.back();
    const WheelErrors errors = current_errors();
    keyframe.motion = motion_.motion();
    keyframe.travel_m = before.travel_m + keyframe.motion.travel_m;
    const int stretch = static_cast<int>(keyframe.travel_m / config_.calibration_travel_m);
    if (stretch > static_cast<int>(before.travel_m / config_.calibration_travel_m)) {
      map_.graph.calibrations.push_back(errors);
    }
    keyframe.calibration = static_cast<int>(map_.graph.calibrations.size()) - 1;
    const Eigen::Vector3d delta = keyframe.motion.delta_with(errors);
    const Eigen::Matrix3d Q = motion_covariance();
    keyframe.T_map_base = compose(before.T_map_base, delta);
    keyframe.covariance = compose_covariance(before.T_map_base, before.covariance, delta, Q);
    keyframe.local_covariance =
        compose_covariance(before.T_map_base, before.local_covariance, delta, Q);
  }
  map_.graph.keyframes.push_back(std::move(keyframe));
  motion_.restart(current_errors());
  num_scans_ = 0;
  if (local_sd_m() > config_.lost_sd_m || num_ambiguous_ >= kAmbiguousScans) begin_anew();
  refresh_local_map();
}

double TrunkSlam::local_sd_m() const {
  const Eigen::Matrix3d& P = map_.graph.keyframes.back().local_covariance;
  return std::sqrt(std::max(P(0, 0), P(1, 1)));
}

/// A map of its own from the newest keyframe on, until a loop closure says where it belongs.
void TrunkSlam::begin_anew() {
  map_.since = static_cast<int>(map_.graph.keyframes.size()) - 1;
  map_.graph.keyframes.back().local_covariance.setZero();
  num_ambiguous_ = num_contradicted_ = 0;
}

void TrunkSlam::refresh_local_map() {
  const double reach_m = std::min(sight_.farthest_m(), config_.sight_range_max_m) + 3.0;
  map_.local = local_map(map_.graph, map_.index, map_.since, reach_m, config_);
}

AssociationCandidate TrunkSlam::candidate(int landmark) const {
  const SlamLandmark& l = map_.graph.landmarks[landmark];
  AssociationCandidate c;
  c.landmark = landmark;
  c.p_map = l.p_map;
  c.covariance = l.covariance();
  c.width_m = l.width_m;
  c.width_sd_m = l.width_information > 0.0 ? 1.0 / std::sqrt(l.width_information) : 1.0;
  return c;
}

int TrunkSlam::begin_landmark(const ScanPoint& point) {
  const Keyframe& keyframe = map_.graph.keyframes.back();
  const Eigen::Matrix2d R = rotation(keyframe.T_map_base.z());
  SlamLandmark landmark;
  landmark.p_map = transform(keyframe.T_map_base, point.p_base);
  landmark.information = (R * point.covariance * R.transpose()).inverse();
  map_.graph.landmarks.push_back(landmark);
  const int id = static_cast<int>(map_.graph.landmarks.size()) - 1;
  map_.index.insert(id, landmark.p_map);
  map_.local.push_back(id);
  return id;
}

/// Whether what matches nothing tells that the robot is elsewhere: where nothing known is around,
/// and where something known should have been in view for long. Else it is merely new.
bool TrunkSlam::is_elsewhere() {
  const Eigen::Vector3d& T_map_base = map_.graph.keyframes.back().T_map_base;
  bool any_known = false;
  bool any_missed = false;
  for (const int l : map_.local) {
    const SlamLandmark& landmark = map_.graph.landmarks[l];
    if (!landmark.confirmed) continue;
    any_known = true;
    any_missed |= sight_.in_view(transform_back(T_map_base, landmark.p_map));
  }
  if (any_missed) ++num_contradicted_;
  return !any_known || num_contradicted_ >= kContradictedScans;
}

void TrunkSlam::match(const std::vector<ScanPoint>& points) {
  const int newest = static_cast<int>(map_.graph.keyframes.size()) - 1;
  std::vector<AssociationCandidate> candidates;
  candidates.reserve(map_.local.size());
  for (const int l : map_.local) candidates.push_back(candidate(l));
  const Association found = associate(points, candidates, map_.graph.keyframes.back().T_map_base,
                                      map_.graph.keyframes.back().local_covariance, config_);
  num_operations_ += found.num_operations;
  num_ambiguous_ = found.ambiguous ? num_ambiguous_ + 1 : 0;
  num_matched_ = found.num_matched;
  if (num_matched_ > 0) num_contradicted_ = 0;
  if (num_matched_ == 0 && !points.empty() && !found.ambiguous && local_sd_m() > kAnewSdM &&
      is_elsewhere()) {
    begin_anew();
  }
  for (std::size_t p = 0; p < points.size(); ++p) {
    int l = found.landmark[p];
    if (l < 0 && found.is_new[p]) l = begin_landmark(points[p]);
    if (l < 0) continue;
    const ScanPoint& point = points[p];
    map_.graph.add_sighting(newest, l, point.p_base, point.scan_covariance, point.floor_sd_m);
    SlamLandmark& landmark = map_.graph.landmarks[l];
    const double information = 1.0 / (point.width_sd_m * point.width_sd_m);
    landmark.width_m =
        (landmark.width_m * landmark.width_information + point.width_m * information) /
        (landmark.width_information + information);
    landmark.width_information += information;
    sight_.saw(point.p_base);
    if (landmark.confirmed) sight_.saw_again(point.p_base);
  }
}

void TrunkSlam::correct_window() {
  const int newest = static_cast<int>(map_.graph.keyframes.size()) - 1;
  // the keyframe before the window is held: at most the one that the local map began with
  const int first = std::max(newest - config_.window_keyframes, map_.since + 1);
  if (first > newest) return;
  const WindowSolution solution = solve_window(map_.graph, first, map_.calibration, config_);
  num_operations_ += config_.window_keyframes;
  if (solution.solved) {
    map_.graph.keyframes.back().local_covariance = solution.local_covariance;
    compose_covariance_in_map(first, solution.drift_covariance);
  }
  for (const int l : map_.local) {
    const std::vector<int>& seen_by = map_.graph.landmarks[l].keyframes;
    if (!seen_by.empty() && seen_by.back() >= first) map_.graph.replace(l, seen_by.size() < 2);
  }
  if (motion_.silence_s() > config_.gap_s && num_matched_ >= 2) {
    const Keyframe& a = map_.graph.keyframes[newest - 1];
    const Keyframe& b = map_.graph.keyframes[newest];
    const double dt_s = (b.utime - a.utime) * 1e-6;
    const Eigen::Vector3d moved = between(a.T_map_base, b.T_map_base);
    if (dt_s > 0.0) motion_.set_velocity(moved.x() / dt_s, moved.z() / dt_s);
  }
  const int num_keyframes = newest + 1;
  look_for_closure();
  if (num_keyframes >= map_.num_solved * (1.0 + config_.solve_growth) + kSolveMinKeyframes) {
    solve_all(WholeReason::kGrown);
  }
}

/// The newest pose in map: by the drive since the window's first keyframe, or by the old landmarks
/// that it sees again, whichever says more.
void TrunkSlam::compose_covariance_in_map(int first, const Eigen::Matrix3d& drift) {
  Keyframe& now = map_.graph.keyframes.back();
  const auto size = [](const Eigen::Matrix3d& P) { return P(0, 0) + P(1, 1); };
  const int newest = static_cast<int>(map_.graph.keyframes.size()) - 1;
  if (newest > first) {
    const Keyframe& from = map_.graph.keyframes[first];
    const Eigen::Matrix3d P = compose_covariance(from.T_map_base, from.covariance,
                                                 between(from.T_map_base, now.T_map_base), drift);
    if (P.allFinite()) now.covariance = P;
  }
  for (const SlamSighting& s : now.sightings) {
    const int old = map_.graph.landmarks[s.landmark].keyframes.front();
    if (old >= std::min(first, map_.num_solved)) continue;
    const Keyframe& then = map_.graph.keyframes[old];
    const Eigen::Matrix3d back = compose_jacobian_second(then.T_map_base).transpose();
    const Eigen::Matrix3d P = compose_covariance(then.T_map_base, then.covariance,
                                                 between(then.T_map_base, now.T_map_base),
                                                 back * now.local_covariance * back.transpose());
    if (P.allFinite() && size(P) < size(now.covariance)) now.covariance = P;
  }
}

/// Confirms, counts what should have been seen, drops what was not: at the end of a keyframe.
void TrunkSlam::review_landmarks() {
  map_.graph.drop_rare_sightings(config_.sighting_share_min * num_scans_);
  const Keyframe& now = map_.graph.keyframes.back();
  const int newest = static_cast<int>(map_.graph.keyframes.size()) - 1;
  for (const int l : map_.local) {
    SlamLandmark& landmark = map_.graph.landmarks[l];
    if (!landmark.alive || landmark.keyframes.empty()) continue;
    const int num_seen = static_cast<int>(landmark.keyframes.size());
    if (landmark.keyframes.back() == newest) {
      const double span_m =
          now.travel_m - map_.graph.keyframes[landmark.keyframes.front()].travel_m;
      landmark.confirmed = landmark.confirmed || (num_seen >= config_.confirm_keyframes &&
                                                  span_m >= config_.confirm_travel_m);
      continue;
    }
    const Eigen::Vector2d p_base = transform_back(now.T_map_base, landmark.p_map);
    const double bearing_rad = std::atan2(p_base.y(), p_base.x());
    const bool hidden =
        std::any_of(now.sightings.begin(), now.sightings.end(), [&](const SlamSighting& s) {
          const Eigen::Vector2d q = s.position();
          const double apart_rad = geometry::wrap_angle_rad(std::atan2(q.y(), q.x()) - bearing_rad);
          const double margin_rad =
              0.05 + 0.5 * map_.graph.landmarks[s.landmark].width_m / q.norm();
          return q.norm() < p_base.norm() + 0.3 && std::abs(apart_rad) < margin_rad;
        });
    if (sight_.in_view(p_base) && !hidden) ++landmark.num_misses;
    const bool gone = landmark.num_misses >= 3 && landmark.num_misses > 1.5 * num_seen;
    const bool passing = !landmark.confirmed &&
                         now.travel_m - map_.graph.keyframes[landmark.keyframes.back()].travel_m >
                             0.5 * config_.recent_travel_m;
    if (gone || passing) map_.graph.drop(l);
  }
}

bool TrunkSlam::solve_all(WholeReason reason) {
  WholeSolve options;
  options.closing = reason == WholeReason::kClosing;
  ErrorsPrior prior;
  prior.covariance = initial_errors_sd(config_).array().square().matrix().asDiagonal();
  Eigen::Matrix3d errors_covariance = map_.calibration.covariance;
  map_.num_solved = static_cast<int>(map_.graph.keyframes.size());
  const auto num_landmarks =
      std::count_if(map_.graph.landmarks.begin(), map_.graph.landmarks.end(),
                    [](const SlamLandmark& l) { return l.keyframes.size() >= 2; });
  const bool fine = map_.num_solved <= config_.solve_keyframes ||
                    (reason == WholeReason::kEnd && map_.num_solved <= config_.final_keyframes &&
                     5 * num_landmarks <= config_.final_keyframes);
  if (fine) {
    if (!solve_whole(map_.graph, prior, options, config_, &errors_covariance)) return false;
  } else {
    StretchGraph stretches = stretches_of(map_.graph, config_);
    if (!solve_whole(stretches.graph, prior, options, config_, &errors_covariance)) return false;
    take_over(stretches, map_.graph);
  }
  if (errors_covariance.allFinite()) map_.calibration = {current_errors(), errors_covariance};
  merge_same();
  for (int l = 0; l < static_cast<int>(map_.graph.landmarks.size()); ++l) {
    const std::size_t num_seen = map_.graph.landmarks[l].keyframes.size();
    if (num_seen > 0) map_.graph.replace(l, num_seen < 2);
  }
  rebuild_index();
  refresh_local_map();
  map_.corrected = true;
  return true;
}

void TrunkSlam::merge_same() {
  rebuild_index();
  for (int l = 0; l < static_cast<int>(map_.graph.landmarks.size()); ++l) {
    if (!map_.graph.landmarks[l].confirmed) continue;
    for (const int other : map_.index.near(map_.graph.landmarks[l].p_map, config_.merge_m)) {
      if (other <= l || !map_.graph.landmarks[other].confirmed) continue;
      const SlamLandmark& a = map_.graph.landmarks[l];
      const SlamLandmark& b = map_.graph.landmarks[other];
      const double apart_m = (b.p_map - a.p_map).norm();
      // one keyframe may have taken a trunk for both, but two trunks never stand in one another
      const bool overlap = apart_m < 0.5 * (a.width_m + b.width_m);
      if (apart_m <= config_.merge_m && (overlap || !map_.graph.seen_together(l, other))) {
        map_.graph.merge(other, l);
      }
    }
  }
}

void TrunkSlam::rebuild_index() {
  map_.index.clear();
  for (int l = 0; l < static_cast<int>(map_.graph.landmarks.size()); ++l) {
    if (map_.graph.landmarks[l].alive) map_.index.insert(l, map_.graph.landmarks[l].p_map);
  }
}

void TrunkSlam::finish() {
  if (map_.graph.keyframes.empty()) return;
  if (motion_.utime() > map_.graph.keyframes.back().utime) open_keyframe();
  solve_all(WholeReason::kEnd);
}

std::optional<PoseEstimate> TrunkSlam::estimate() const {
  if (map_.graph.keyframes.empty()) return std::nullopt;
  const Keyframe& keyframe = map_.graph.keyframes.back();
  const Eigen::Vector3d delta = motion_.motion().delta_with(current_errors());
  const Eigen::Vector3d T = compose(keyframe.T_map_base, delta);
  const Eigen::Matrix3d P =
      compose_covariance(keyframe.T_map_base, keyframe.covariance, delta, motion_covariance());
  if (!T.allFinite() || !P.allFinite()) return std::nullopt;
  PoseEstimate pose;
  pose.utime = motion_.utime();
  pose.x_m = T.x();
  pose.y_m = T.y();
  pose.yaw_rad = T.z();
  pose.covariance = {P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)};
  return pose;
}

std::optional<Trajectory> TrunkSlam::take_correction() {
  if (!map_.corrected) return std::nullopt;
  map_.corrected = false;
  Trajectory trajectory;
  trajectory.utime = motion_.utime();
  trajectory.revision = ++revision_;
  trajectory.poses.reserve(map_.graph.keyframes.size());
  for (const Keyframe& k : map_.graph.keyframes) {
    const Eigen::Matrix3d& P = k.covariance;
    PoseEstimate pose;
    pose.utime = k.utime;
    pose.x_m = k.T_map_base.x();
    pose.y_m = k.T_map_base.y();
    pose.yaw_rad = k.T_map_base.z();
    pose.covariance = {P(0, 0), P(0, 1), P(0, 2), P(1, 1), P(1, 2), P(2, 2)};
    trajectory.poses.push_back(pose);
  }
  return trajectory;
}

std::string TrunkSlam::warning() const {
  if (map_.graph.keyframes.empty()) return {};
  if (motion_.silence_s() > config_.gap_s) {
    return "no motion measured for " + std::to_string(static_cast<int>(motion_.silence_s())) +
           " s: the pose goes on at the last velocity";
  }
  if (num_ambiguous_ > 0) return "AMBIGUOUS: the trunks in view fit more than one place";
  if (map_.since > 0 && !closure_ambiguous_) {
    return "LOST: nothing in view fitted the map for too long; a map of its own until a loop "
           "closes";
  }
  if (closure_ambiguous_) {
    return "AMBIGUOUS: the trunks passed last fit the map in more than one way; no loop is closed";
  }
  return {};
}

}  // namespace orchard::pose
