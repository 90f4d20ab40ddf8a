// SPDX-License-Identifier: BSD-3-Clause
#include "pose/rig/rig_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "text/number_text.hpp"
#include "timing/units.hpp"

namespace orchard::pose {
namespace {

using geometry::between;
using geometry::compose;

// derived: scans are matched so often that neighbours show the same surfaces, and a stretch is so
// long that its motion is a hundred times the error of matching.
constexpr double kKeyWay_m = 0.3;
constexpr double kKeyTurn_rad = 0.15;
constexpr double kStretchWay_m = 1.0;
constexpr double kStretchTurn_rad = 0.5;
/// derived: the errors fall by the root of their number: twenty stretches tell a degree, 150, a
/// drive of some hundred metres, a third of that. More would only cost; so would keys without end
/// where scans do not determine the motion.
constexpr std::size_t kStretchesMax = 150;
/// derived: half of them may be straight; turns alone tell the mount, and rows may be long.
constexpr std::size_t kStraightMax = kStretchesMax / 2;
constexpr std::size_t kKeysMax = 1000;
constexpr std::size_t kFirstJudgement = 50;
/// derived: twenty seconds of scans at 10 Hz; who is later than that does not come.
constexpr std::size_t kWaitingMax = 200;
/// derived: a difference over this span to either side tells how the reference changes if it is
/// late; as long as a delay that matters, because a robot begins to turn at once.
constexpr std::int64_t kLagSpan_us = 250'000;
/// derived: a position between two fixes this far apart is as good as they are.
constexpr double kFixGap_s = 0.6;
/// derived: an hour of fixes at 5 Hz; the scanner's path has ended by then.
constexpr std::size_t kPositionsMax = 20'000;
/// derived: keys of one registration to the fixes: over some 20 m drift and slow errors are small.
constexpr std::size_t kKeysPerView = 60;

/// derived: 1 in 16,000, before a rig is said to be wrong.
constexpr double kCertain_sigma = 4.0;
// physical: what a person measures with ruler and eye is within a third of this.
constexpr double kYawTolerance_rad = 0.045;
constexpr double kMountTolerance_m = 0.15;
constexpr double kAntennaTolerance_m = 0.25;
/// physical: wheels are known to a few hundredths (tyres, slip); a tenth is another gear.
constexpr double kScaleTolerance = 0.10;
/// physical: sensors stamp within a tenth of a second, what is buffered comes later.
constexpr double kLagTolerance_s = 0.10;

bool contradicts(const Estimate& seen, double stated, double tolerance) {
  const double off = std::abs(seen.value - stated);
  return off > tolerance && off > kCertain_sigma * seen.sd;
}

bool yaw_contradicts(const Estimate& seen, double stated_rad) {
  const Estimate off{geometry::wrap_angle_rad(seen.value - stated_rad), seen.sd};
  return contradicts(off, 0.0, kYawTolerance_rad);
}

bool mount_contradicts(const MountEstimate& seen, const laser::LaserConfig& stated) {
  return contradicts(seen.mount_x_m, stated.mount_x_m, kMountTolerance_m) ||
         contradicts(seen.mount_y_m, stated.mount_y_m, kMountTolerance_m);
}

bool fits(const MountEstimate& seen, const laser::LaserConfig& stated) {
  return !seen.is_mirrored && !yaw_contradicts(seen.mount_yaw_rad, stated.mount_yaw_rad) &&
         !mount_contradicts(seen, stated);
}

std::string with_sd(const Estimate& e, int num_decimals) {
  return fixed_text(e.value, num_decimals) + " +- " + fixed_text(e.sd, num_decimals);
}

const char* reference_name(bool by_wheels) { return by_wheels ? "the wheels" : "the fixes"; }

std::string by_text(const MountEstimate& seen, bool by_wheels) {
  return " (by " + std::to_string(seen.num_pairs) + " motions of " + reference_name(by_wheels) +
         " and SCAN)";
}

/// Findings about one scanner; `section` is laser or laser_rear.
void judge_scanner(const MountEstimate& seen, const laser::LaserConfig& stated,
                   const std::string& section, bool by_wheels, std::vector<Finding>& findings) {
  const std::string by = by_text(seen, by_wheels);
  if (seen.is_mirrored) {
    findings.push_back(
        {"mirrored", "drivers." + section,
         std::string("the scans turn the other way than ") + reference_name(by_wheels) +
             " tell: the map is a mirror image if the scanner is mounted upside down (its driver "
             "must then send a negative bearing_step_rad), or " +
             (by_wheels ? "the wheels' yaw rate has the wrong sign" : "the fixes' yaw has") + by});
    return;
  }
  if (yaw_contradicts(seen.mount_yaw_rad, stated.mount_yaw_rad)) {
    findings.push_back({"laser_yaw", section + ".mount_yaw_rad",
                        section + ".mount_yaw_rad is " + fixed_text(stated.mount_yaw_rad, 3) +
                            ", but the scans move as with " + with_sd(seen.mount_yaw_rad, 3) + by});
  }
  if (mount_contradicts(seen, stated)) {
    findings.push_back(
        {"laser_mount", section + ".mount_x_m",
         section + ".mount_x_m and mount_y_m are " + fixed_text(stated.mount_x_m, 2) + " and " +
             fixed_text(stated.mount_y_m, 2) + ", but the scans move as with " +
             with_sd(seen.mount_x_m, 2) + " and " + with_sd(seen.mount_y_m, 2) + by});
  }
}

/// Findings about the wheels, by the scans of the front scanner.
void judge_wheels(const MountEstimate& seen, std::vector<Finding>& findings) {
  const std::string by = by_text(seen, true);
  if (contradicts(seen.way_scale, 1.0, kScaleTolerance)) {
    findings.push_back(
        {"wheels_scale", "drivers.odometry",
         "a metre of ODOMETRY is " + with_sd(seen.way_scale, 3) +
             " m by the scans: multiply the metres per tick (the wheels' diameter) in the "
             "odometry driver by it" +
             by});
  }
  if (contradicts(seen.reference_lag_s, 0.0, kLagTolerance_s)) {
    findings.push_back({"wheels_delay", "drivers.odometry",
                        "ODOMETRY tells a motion " + with_sd(seen.reference_lag_s, 2) +
                            " s later than SCAN: the two are stamped by different clocks, or one "
                            "of them waits in a buffer before it is stamped" +
                            by});
  }
}

void judge_antenna(const AntennaEstimate& seen, const RigFacts& facts,
                   std::vector<Finding>& findings) {
  const laser::LaserConfig& laser = facts.laser;
  const Eigen::Vector2d p_base_m = geometry::transform(
      Eigen::Vector3d(laser.mount_x_m, laser.mount_y_m, laser.mount_yaw_rad), seen.p_laser_m);
  const Eigen::Matrix2d R = geometry::rotation(laser.mount_yaw_rad);
  const Eigen::Matrix2d P = R * seen.covariance * R.transpose();
  const Estimate x{p_base_m.x(), std::sqrt(P(0, 0))}, y{p_base_m.y(), std::sqrt(P(1, 1))};
  const auto& stated_m = facts.gnss.antenna_m;
  if (!contradicts(x, stated_m[0], kAntennaTolerance_m) &&
      !contradicts(y, stated_m[1], kAntennaTolerance_m)) {
    return;
  }
  findings.push_back({"antenna", "pose.gnss.antenna_m",
                      "pose.gnss.antenna_m is [" + fixed_text(stated_m[0], 2) + ", " +
                          fixed_text(stated_m[1], 2) + "], but in turns the fixes move as with [" +
                          with_sd(x, 2) + ", " + with_sd(y, 2) + "] (by " +
                          std::to_string(seen.num_fixes) + " fixes along the scanner's path)"});
}

/// derived: a degree of a full turn; more beams tell the motion hardly better and only cost.
constexpr std::size_t kBeamsMax = 360;

/// Every so-manieth beam of a scan.
laser::Scan thinned_out(const laser::Scan& scan) {
  const std::size_t step = scan.ranges_m.size() / kBeamsMax + 1;
  laser::Scan few = scan;
  few.intensities.clear();
  few.ranges_m.clear();
  few.bearings_rad.clear();
  for (std::size_t i = 0; i < scan.ranges_m.size(); i += step) {
    few.ranges_m.push_back(scan.ranges_m[i]);
    if (!scan.bearings_rad.empty()) few.bearings_rad.push_back(scan.bearings_rad[i]);
  }
  few.bearing_step_rad *= static_cast<double>(step);
  few.beam_period_us *= static_cast<double>(step);
  return few;
}

/// Scans are near enough to each other for their guesses; all turns are still tried.
PoseConfig without_search(const ScanMotionConfig& scan_motion) {
  PoseConfig config;
  config.scan_motion = scan_motion;
  config.scan_motion.search_shift_m = 0.0;
  return config;
}

/// The scanner's own frame takes the place of base: its motion is what is asked for.
laser::LaserConfig at_origin() { return {}; }

}  // namespace

ScannerPath::ScannerPath(const ScanMotionConfig& config, const laser::BlindSector& blind,
                         const laser::LaserConfig& stated)
    : config_(without_search(config)),
      blind_(blind),
      motion_(config_, at_origin(), blind_),
      T_base_laser_(stated.mount_x_m, stated.mount_y_m, stated.mount_yaw_rad) {}

bool ScannerPath::is_complete() const {
  return pairs_.size() >= kStretchesMax || keys_.size() >= kKeysMax;
}

void ScannerPath::add(const laser::Scan& scan) {
  if (is_complete()) return;
  waiting_.push_back(thinned_out(scan));
  if (waiting_.size() > kWaitingMax) waiting_.pop_front();
}

std::optional<std::int64_t> ScannerPath::oldest_utime() const {
  if (!waiting_.empty()) return waiting_.front().utime;
  return std::nullopt;
}

void ScannerPath::advance(const ReferencePath& reference, bool ended) {
  const std::optional<std::int64_t> reached = reference.reached_utime();
  while (!waiting_.empty() && !is_complete()) {
    const std::int64_t utime = waiting_.front().utime;
    if (!ended && (!reached || *reached < utime + kLagSpan_us)) return;
    use(waiting_.front(), anchor_at(reference, utime));
    waiting_.pop_front();
  }
}

std::optional<ScannerPath::Anchor> ScannerPath::anchor_at(const ReferencePath& reference,
                                                          std::int64_t utime) {
  const auto place = reference.at(utime);
  if (!place) return std::nullopt;
  return Anchor{utime, *place, reference.at(utime - kLagSpan_us),
                reference.at(utime + kLagSpan_us)};
}

void ScannerPath::use(const laser::Scan& scan, const std::optional<Anchor>& anchor) {
  if (!anchor) return;
  if (last_key_ && last_key_->place.piece == anchor->place.piece) {
    const Eigen::Vector3d moved = between(last_key_->place.T_path_base, anchor->place.T_path_base);
    if (moved.head<2>().norm() < kKeyWay_m && std::abs(moved.z()) < kKeyTurn_rad) return;
    const bool turns = std::abs(moved.z()) > kKeyTurn_rad * kKeyWay_m / kStretchWay_m;
    if (num_straight_ >= kStraightMax && !turns) {
      if (stretch_start_) motion_ = ScanMotion(config_, at_origin(), blind_);
      stretch_start_.reset();
      last_key_ = anchor;
      return;
    }
  }
  match(scan, *anchor);
  last_key_ = anchor;
}

void ScannerPath::match(const laser::Scan& scan, const Anchor& anchor) {
  std::optional<Eigen::Vector3d> predicted;
  if (last_key_ && last_key_->place.piece == anchor.place.piece) {
    const Eigen::Vector3d moved = between(last_key_->place.T_path_base, anchor.place.T_path_base);
    predicted = between(T_base_laser_, compose(moved, T_base_laser_));
  }
  const std::optional<MeasuredMotion> motion = motion_.add(scan, predicted);
  const bool follows = motion && motion->reliable && stretch_start_ &&
                       stretch_start_->place.piece == anchor.place.piece;
  if (motion && !motion->reliable) ++num_lost_;
  if (!follows) {
    stretch_start_ = anchor;
    T_start_laser_.setZero();
    const int piece = keys_.empty() ? 0 : keys_.back().piece + 1;
    keys_.push_back({anchor.utime, Eigen::Vector3d::Zero(), piece});
    return;
  }
  T_start_laser_ = compose(T_start_laser_, motion->T_from_to);
  keys_.push_back(
      {anchor.utime, compose(keys_.back().T_path_laser, motion->T_from_to), keys_.back().piece});
  if (T_start_laser_.head<2>().norm() < kStretchWay_m &&
      std::abs(T_start_laser_.z()) < kStretchTurn_rad) {
    return;
  }
  end_stretch(anchor);
}

void ScannerPath::end_stretch(const Anchor& anchor) {
  const Anchor& start = *stretch_start_;
  MotionPair pair;
  pair.laser = T_start_laser_;
  pair.reference = between(start.place.T_path_base, anchor.place.T_path_base);
  pair.duration_s = timing::seconds(anchor.utime - start.utime);
  if (start.before && start.after && anchor.before && anchor.after) {
    const Eigen::Vector3d earlier = between(start.before->T_path_base, anchor.before->T_path_base);
    const Eigen::Vector3d later = between(start.after->T_path_base, anchor.after->T_path_base);
    pair.reference_rate = (later - earlier) / (2.0 * timing::seconds(kLagSpan_us));
    pair.reference_rate.z() =
        geometry::wrap_angle_rad(later.z() - earlier.z()) / (2.0 * timing::seconds(kLagSpan_us));
  }
  pairs_.push_back(pair);
  if (std::abs(T_start_laser_.z()) < kKeyTurn_rad) ++num_straight_;
  stretch_start_ = anchor;
  T_start_laser_.setZero();
}

RigMonitor::RigMonitor(const RigFacts& facts)
    : facts_(facts),
      front_(facts.scan_motion, facts.blind, facts.laser),
      rear_(facts.scan_motion, facts.blind, facts.laser_rear),
      gnss_(facts.gnss),
      next_judgement_(kFirstJudgement) {}

const ReferencePath* RigMonitor::reference() const {
  if (has_wheels_) return &wheels_;
  return has_fixes_ ? &fixes_ : nullptr;
}

void RigMonitor::add(const Odometry& odometry) {
  if (front_.is_complete()) return;
  has_wheels_ = true;
  wheels_.add(odometry);
  advance(false);
}

void RigMonitor::add(const PoseFix& fix) {
  if (front_.is_complete() || has_wheels_) return;
  has_fixes_ = has_fixes_ || fix.has_yaw;
  fixes_.add(fix);
  advance(false);
}

void RigMonitor::add(const Gnss& gnss) {
  if (front_.is_complete() || positions_.size() >= kPositionsMax) return;
  if (const auto position = gnss_.add(gnss)) {
    if (positions_.empty() || position->utime > positions_.back().utime) {
      positions_.push_back(*position);
    }
  }
}

void RigMonitor::add(const laser::Scan& scan) {
  front_.add(scan);
  advance(false);
}

void RigMonitor::add_rear(const laser::Scan& scan) {
  rear_.add(scan);
  advance(false);
}

void RigMonitor::finish() {
  advance(true);
  judge();
}

void RigMonitor::advance(bool ended) {
  const ReferencePath* path = reference();
  if (path == nullptr) return;
  front_.advance(*path, ended);
  rear_.advance(*path, ended);
  if (front_.pairs().size() >= next_judgement_) {
    judge();
    next_judgement_ *= 2;
  }
  const auto reached = path->reached_utime();
  std::int64_t needed = reached.value_or(0);
  for (const ScannerPath* scanner : {&front_, &rear_}) {
    needed = std::min(needed, scanner->oldest_utime().value_or(needed));
  }
  (has_wheels_ ? wheels_ : fixes_).forget_before(needed - 2 * kLagSpan_us);
}

std::vector<std::vector<AntennaView>> RigMonitor::antenna_views() const {
  std::vector<std::vector<AntennaView>> stretches;
  int piece = -1;
  std::size_t at = 0;
  for (const ScannerPath::Key& key : front_.keys()) {
    while (at < positions_.size() && positions_[at].utime < key.utime) ++at;
    if (at == 0 || at >= positions_.size()) continue;
    const GnssPosition &before = positions_[at - 1], &after = positions_[at];
    const double gap_s = timing::seconds(after.utime - before.utime);
    if (gap_s > kFixGap_s) continue;
    const double share = timing::seconds(key.utime - before.utime) / gap_s;
    if (key.piece != piece || stretches.back().size() >= kKeysPerView) stretches.emplace_back();
    piece = key.piece;
    stretches.back().push_back(
        {key.T_path_laser, before.p_enu_m + share * (after.p_enu_m - before.p_enu_m)});
  }
  // A short stretch only adds unknowns.
  stretches.erase(std::remove_if(stretches.begin(), stretches.end(),
                                 [](const auto& views) { return views.size() < 20; }),
                  stretches.end());
  return stretches;
}

void RigMonitor::judge() {
  estimates_ = {};
  findings_.clear();
  estimates_.by_wheels = has_wheels_;
  estimates_.laser = estimate_mount(front_.pairs());
  estimates_.laser_rear = estimate_mount(rear_.pairs());
  estimates_.antenna = estimate_antenna(antenna_views());
  estimates_.scans_determined = front_.determined();
  const auto& [laser, laser_rear, by_wheels, antenna, determined] = estimates_;
  const bool are_exchanged = facts_.laser_rear.enabled && laser && laser_rear &&
                             !fits(*laser, facts_.laser) && fits(*laser, facts_.laser_rear) &&
                             fits(*laser_rear, facts_.laser);
  if (are_exchanged) {
    findings_.push_back(
        {"scanners_exchanged", "laser_rear",
         "SCAN moves as the scanner of section laser_rear and SCAN.rear as that of section laser: "
         "exchange the two devices or the two sections" +
             by_text(*laser, by_wheels)});
  } else {
    if (laser) judge_scanner(*laser, facts_.laser, "laser", by_wheels, findings_);
    if (laser_rear && facts_.laser_rear.enabled) {
      judge_scanner(*laser_rear, facts_.laser_rear, "laser_rear", by_wheels, findings_);
    }
  }
  if (laser && by_wheels) judge_wheels(*laser, findings_);
  if (antenna && findings_.empty()) judge_antenna(*antenna, facts_, findings_);
}

}  // namespace orchard::pose
