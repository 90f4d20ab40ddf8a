// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/prior_map_localiser.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include "geometry/pose2.hpp"
#include "geometry/symmetric.hpp"
#include "pose/motion.hpp"
#include "pose/tuning.hpp"
#include "text/number_text.hpp"
#include "timing/units.hpp"

namespace orchard::pose {

using geometry::compose;
namespace {

// Thresholds for accepting, checking and giving up a position in a prior map.

// derived: travel between two searches or checks [m], in which a scan shows another tree; and a
// bound on the cost of a scan. Constellations of fewer trunks repeat in an orchard.
constexpr double kSearchInterval_m = 1.0;
constexpr std::size_t kTrunksMin = 6;
constexpr int kHypothesesPerScan = 400;

// derived: min natural log-odds of a position against all others together (1 in 8,000); min
// log-likelihood ratio of a position against another orchard.
constexpr double kLogOddsMin = 9.0;
constexpr double kLogFitMin = 0.0;

// derived: at 0.3 of the trees' spacing [m], three standard deviations reach the neighbour: no
// trunk may be taken for a landmark by its place alone. A place is taken by the same odds, one that
// was stated is given up when it has a tenth, and one that a search found has no rival twice as
// probable. Four trees show a half, and one contradicting check may be by chance. The trunks within
// 1.5 detection ranges check the present position.
constexpr double kVagueSd_m = 1.0;
constexpr double kVagueSpacings = 0.3;
constexpr double kSure = 1.0 - 1.0 / 8'000.0;
constexpr double kUnlikely = 0.1;
constexpr double kRivalled = 0.5;
constexpr int kExpectedTreesMin = 4;
constexpr int kContradictionsMin = 2;
constexpr double kNearby_ranges = 1.5;

// physical: velocity of a robot whose motion is not measured; limit of a jump of time [s].
constexpr double kUnmeasuredSpeedSd_mps = 0.5;
constexpr double kUnmeasuredYawRateSd_radps = 0.3;
constexpr double kMaxStep_s = 1e6;

std::string pose_text(const PoseHypothesis& hypothesis) {
  return "(" + fixed_text(hypothesis.T_map_base.x(), 1) + ", " +
         fixed_text(hypothesis.T_map_base.y(), 1) + ") m";
}

bool is_sound(const Odometry& o) {
  return std::isfinite(o.speed_mps) && std::isfinite(o.yaw_rate_radps) &&
         std::isfinite(o.covariance[0]) && std::isfinite(o.covariance[1]) &&
         std::isfinite(o.covariance[2]);
}

PriorMapData checked(PriorMapData earlier) {
  const std::string problem = problem_with(earlier.landmarks);
  if (!problem.empty()) throw std::invalid_argument("the prior map " + problem);
  earlier.landmarks = without_duplicates(earlier.landmarks);
  return earlier;
}

double largest_sd_m(const Eigen::Matrix3d& P) {
  return std::sqrt(std::max(0.0, geometry::axes_of(P.topLeftCorner<2, 2>()).values(1)));
}

}  // namespace

PriorMapLocaliser::PriorMapLocaliser(const PoseConfig& config, const PriorMapData& earlier,
                                     const laser::LaserConfig& mount,
                                     const laser::BlindSector& blind)
    : pose_config_(config),
      config_(config.prior_map),
      map_(checked(earlier), kHypothesisPairMax_m),
      field_(config_.detection_range_m),
      local_(config_),
      tracker_(map_, config_) {
  if (reads_scans(config)) {
    scan_motion_.emplace(config, mount, blind);
  }
  state_ = "LOST: no trunk was observed yet";
}

void PriorMapLocaliser::add(const Measurement& measurement) {
  if (scan_motion_) {
    if (const auto* odometry = std::get_if<Odometry>(&measurement)) scan_motion_->add(*odometry);
    if (const auto* scan = std::get_if<laser::Scan>(&measurement)) add(*scan);
  } else if (const auto* odometry = std::get_if<Odometry>(&measurement)) {
    add(*odometry);
  }
  if (const auto* seen = std::get_if<detection::Detections>(&measurement)) add(*seen);
}

void PriorMapLocaliser::add(const Odometry& odometry) {
  if (!is_sound(odometry) || (utime_ && odometry.utime < *utime_)) return;
  begin_at(odometry.utime);
  advance_to(odometry.utime, odometry.speed_mps, odometry.yaw_rate_radps, covariance_of(odometry));
  last_odometry_ = odometry;
}

void PriorMapLocaliser::add(const laser::Scan& scan) {
  const std::optional<MeasuredMotion> motion = scan_motion_->add(scan);
  if (!motion) {
    if (!utime_) begin_at(scan.utime);
    return;
  }
  num_unreliable_ = motion->reliable ? 0 : num_unreliable_ + 1;
  if (!motion->has_place) return;
  utime_ = motion->utime_to;
  last_motion_ = *motion;
  move(motion->T_from_to, motion->covariance);
  if (belief_ && tracking_ && !motion->reliable) belief_->doubt_motion();
}

void PriorMapLocaliser::move(const Eigen::Vector3d& T_base_next,
                             const Eigen::Matrix3d& covariance) {
  const double travel_m = T_base_next.head<2>().norm();
  local_.move(T_base_next, covariance, travel_m);
  if (since_kidnapping_) since_kidnapping_->move(T_base_next, covariance, travel_m);
  if (belief_) belief_->move(T_base_next, covariance, travel_m);
  if (tracking_) tracker_.move(T_base_next, covariance);
}

void PriorMapLocaliser::add(const detection::Detections& seen) {
  if (utime_ && seen.utime < *utime_) return;
  // What a scan shows tells nothing as long as the motion to it is not known.
  if (utime_ && scan_motion_ && seen.utime > *utime_) return;
  begin_at(seen.utime);
  double speed_mps = 0.0, yaw_rate_radps = 0.0;
  if (scan_motion_) {
    // Detections have the utime of their scan, to which scan matching has already moved base.
    const double dt_s = timing::seconds(last_motion_.utime_to - last_motion_.utime_from);
    if (dt_s > 0.0) {
      speed_mps = last_motion_.T_from_to.x() / dt_s;
      yaw_rate_radps = last_motion_.T_from_to.z() / dt_s;
    }
  } else {
    advance_to(seen.utime);
    if (last_odometry_) speed_mps = last_odometry_->speed_mps;
    if (last_odometry_) yaw_rate_radps = last_odometry_->yaw_rate_radps;
  }
  const std::vector<ScanObservation> observations =
      scan_observations(seen, speed_mps, yaw_rate_radps, config_);
  field_.learn(observations);
  local_.observe(observations, field_);
  watch_for_kidnapping(observations);
  if (tracking_ && is_vague(tracker_.covariance())) become_vague();
  if (!tracking_ && !belief_) believe_anywhere(observations);
  if (belief_) watch_belief(observations);
  if (tracking_) {
    track(observations);
  } else {
    search();  // it may find a place before the belief is sure, but none that this refutes
  }
}

void PriorMapLocaliser::begin_at(std::int64_t utime) {
  if (utime_) return;
  utime_ = utime;
  if (config_.start != PriorStart::kGiven) return;
  const double position_variance =
      PriorMapConfig::kStartPositionSd_m * PriorMapConfig::kStartPositionSd_m;
  const double yaw_variance = PriorMapConfig::kStartYawSd_rad * PriorMapConfig::kStartYawSd_rad;
  const Eigen::Vector3d start(config_.start_x_m, config_.start_y_m, config_.start_yaw_rad);
  const Eigen::Matrix3d covariance =
      Eigen::Vector3d(position_variance, position_variance, yaw_variance).asDiagonal();
  tracker_.start(start, covariance);
  belief_.emplace(map_);
  belief_->start_stated(start, covariance);
  must_be_tested_ = !map_.was_seen(start.head<2>());
  tracking_ = true;
  state_.clear();
}

double PriorMapLocaliser::time_since_motion_s() const {
  if (!last_odometry_) return kMaxStep_s;
  return timing::seconds(*utime_ - last_odometry_->utime);
}

void PriorMapLocaliser::advance_to(std::int64_t utime) {
  const double silence =
      last_odometry_ ? timing::seconds(utime - last_odometry_->utime) : kMaxStep_s;
  const double speed_mps = last_odometry_ ? last_odometry_->speed_mps : 0.0;
  const double yaw_rate_radps = last_odometry_ ? last_odometry_->yaw_rate_radps : 0.0;
  if (silence <= PoseConfig::kOdometryGapMax_s) {
    advance_to(utime, speed_mps, yaw_rate_radps, covariance_of(*last_odometry_));
  } else {
    advance_to(utime, speed_mps, yaw_rate_radps,
               {kUnmeasuredSpeedSd_mps * kUnmeasuredSpeedSd_mps, 0.0,
                kUnmeasuredYawRateSd_radps * kUnmeasuredYawRateSd_radps});
  }
}

void PriorMapLocaliser::advance_to(std::int64_t utime, double speed_mps, double yaw_rate_radps,
                                   const std::array<double, 3>& covariance) {
  const double dt_s = std::min(kMaxStep_s, timing::seconds(utime - *utime_));
  utime_ = utime;
  if (dt_s <= 0.0) return;
  const WheelStep step{speed_mps, yaw_rate_radps, covariance, dt_s};
  const Eigen::Vector3d T_base_next = tracker_.motion(step);
  const Eigen::Matrix3d covariance_next = tracker_.motion_covariance(step);
  const double travel_m = std::abs(speed_mps) * dt_s;
  local_.move(T_base_next, covariance_next, travel_m);
  if (since_kidnapping_) since_kidnapping_->move(T_base_next, covariance_next, travel_m);
  if (belief_) belief_->move(T_base_next, covariance_next, travel_m);
  if (tracking_) tracker_.move(step);
}

std::array<double, 3> PriorMapLocaliser::covariance_of(const Odometry& odometry) const {
  if (odometry.covariance[0] > 0.0 || odometry.covariance[2] > 0.0) return odometry.covariance;
  const double speed_sd_mps = pose_config_.speed_sd_fraction * odometry.speed_mps;
  return {speed_sd_mps * speed_sd_mps, 0.0,
          pose_config_.yaw_rate_sd_radps * pose_config_.yaw_rate_sd_radps};
}

void PriorMapLocaliser::restart_local_map() {
  if (since_kidnapping_) {
    local_ = *std::move(since_kidnapping_);
    since_kidnapping_.reset();
    lost_travel_m_ = kidnapping_travel_m_;
  } else {
    local_.clear();
    lost_travel_m_ = local_.travel_m();
  }
  search_.reset();
  checked_travel_m_ = local_.travel_m();
  checked_trunks_ = 0;
}

LocalEvidence PriorMapLocaliser::evidence(const LocalTrunkMap& local) const {
  LocalEvidence evidence{local.trunks(map_.clump_reach_m()), local.views(), field_};
  // After a headland turn with uncalibrated wheels, older trunks may be displaced relative to base.
  const auto bent = std::find_if(
      evidence.trunks.begin(), evidence.trunks.end(), [](const LocalTrunkMap::Trunk& trunk) {
        return 0.5 * trunk.covariance.trace() > kDistortedSd_m * kDistortedSd_m;
      });
  if (bent == evidence.trunks.end()) return evidence;
  const double until_m = bent->last_travel_m;
  evidence.trunks.erase(bent, evidence.trunks.end());
  while (!evidence.views.empty() && evidence.views.front().travel_m <= until_m) {
    evidence.views.pop_front();
  }
  return evidence;
}

void PriorMapLocaliser::search() {
  if (local_.is_inconsistent()) {
    restart_local_map();
    state_ = "LOST: the robot was moved during localisation; localisation starts again";
  }
  if (!search_) {
    const std::size_t num_trunks = local_.trunks().size();
    const bool enough = num_trunks >= kTrunksMin;
    const bool due = local_.travel_m() - checked_travel_m_ >= kSearchInterval_m ||
                     num_trunks >= checked_trunks_ + 2;
    if (!enough || !due) return;
    local_.reset_origin();
    checked_travel_m_ = local_.travel_m();
    checked_trunks_ = num_trunks;
    LocalEvidence local = evidence(local_);
    if (local.trunks.size() < kTrunksMin) return;
    search_.emplace(map_, config_, std::move(local));
  }
  if (!search_->step(kHypothesesPerScan)) return;
  decide_on_result(search_->result());
  search_.reset();
}

void PriorMapLocaliser::decide_on_result(const SearchResult& result) {
  const std::string since =
      std::to_string(checked_trunks_) + " trunks of the last " +
      fixed_text(std::min(config_.window_m, local_.travel_m() - lost_travel_m_), 0) + " m";
  if (result.hypotheses.empty() || result.log_fit < kLogFitMin) {
    state_ = "LOST: the " + since + " do not fit any place of the prior map; drive on, or " +
             "check that it is the map of this orchard";
    return;
  }
  if (result.log_odds < kLogOddsMin) {
    const auto num = std::count_if(result.hypotheses.begin(), result.hypotheses.end(),
                                   [&](const PoseHypothesis& p) {
                                     return p.score > result.hypotheses.front().score - kLogOddsMin;
                                   });
    state_ = "AMBIGUOUS: the " + since + " fit " + std::to_string(num) +
             " places of the prior map about equally well, such as " +
             pose_text(result.hypotheses[0]) + " and " + pose_text(result.hypotheses[1]) +
             "; drive on";
    return;
  }
  // Base has moved since the search began; T_local_base is relative to its frame.
  const PoseHypothesis& hypothesis = result.hypotheses.front();
  const Eigen::Vector3d T_map_base = compose(hypothesis.T_map_base, local_.T_local_base());
  const Eigen::Matrix3d covariance =
      compose_covariance(hypothesis.T_map_base, hypothesis.covariance, local_.T_local_base(),
                         local_.pose_covariance());
  if (belief_ && belief_->probability_at(T_map_base) < kRivalled * belief_->place().weight) return;
  belief_.emplace(map_);
  belief_->start(T_map_base, covariance);
  must_be_tested_ = false;
  place_at(T_map_base, covariance);
}

void PriorMapLocaliser::place_at(const Eigen::Vector3d& T_map_base,
                                 const Eigen::Matrix3d& covariance) {
  tracker_.start(T_map_base, covariance);
  tracking_ = is_confirmed_ = true;
  state_.clear();
  watch_.clear();
  num_contradictions_ = 0;
}

void PriorMapLocaliser::declare_lost(const std::string& why, bool forget_trunks) {
  tracking_ = false;
  belief_.reset();
  ++num_lost_;
  search_.reset();
  watch_.clear();
  num_contradictions_ = 0;
  checked_trunks_ = 0;
  lost_travel_m_ = local_.travel_m();
  if (forget_trunks) restart_local_map();
  state_ = "LOST: " + why;
}

std::optional<PoseEstimate> PriorMapLocaliser::estimate() const {
  if (!tracking_ || !utime_) return std::nullopt;
  Eigen::Vector3d T = tracker_.T_map_base();
  const Eigen::Matrix3d P = tracker_.covariance();
  if (!T.allFinite() || !P.allFinite()) return std::nullopt;
  T.z() = geometry::wrap_angle_rad(T.z());
  return pose_estimate(*utime_, T, P);
}

std::string PriorMapLocaliser::warning() const {
  const std::string place = place_warning(), motion = motion_warning();
  return place + (place.empty() || motion.empty() ? "" : "; ") + motion;
}

std::string PriorMapLocaliser::place_warning() const {
  if (belief_ && tracking_ && !is_confirmed_) {
    return "UNCONFIRMED: the trunks around do not tell yet whether this place is right: " +
           fixed_text(100.0 * belief_->probability_at(tracker_.T_map_base()), 0) + " %";
  }
  // A place at which most landmarks in view are missed is none.
  if (belief_ && !tracking_ && (state_.empty() || belief_->place().seen >= kTrunksMin)) {
    const WeighedPlace& place = belief_->place();
    return "AMBIGUOUS: the trunks around do not tell the place; the likeliest, (" +
           fixed_text(place.T_map_base.x(), 1) + ", " + fixed_text(place.T_map_base.y(), 1) +
           ") m, has " + fixed_text(100.0 * place.weight, 0) + " %; drive on";
  }
  return tracking_ ? "" : state_;
}

std::string PriorMapLocaliser::motion_warning() const {
  if (num_unreliable_ > 0) {
    const std::string scans =
        num_unreliable_ == 1 ? "scan" : std::to_string(num_unreliable_) + " scans";
    return "the last " + scans + " could not be matched: the motion between trees is extrapolated";
  }
  if (last_odometry_ && time_since_motion_s() > PoseConfig::kOdometryGapMax_s) {
    return "no ODOMETRY for " + fixed_text(time_since_motion_s(), 1) +
           " s: the motion between scans is extrapolated";
  }
  return {};
}

void PriorMapLocaliser::watch_for_kidnapping(const std::vector<ScanObservation>& observations) {
  if (since_kidnapping_) since_kidnapping_->observe(observations, field_);
  const bool anew = since_kidnapping_ ? since_kidnapping_->last_scan_contradicts()
                                      : local_.last_scan_contradicts();
  if (!anew) {
    // After window_m of travel local_ contains no older trunks either.
    if (local_.travel_m() - kidnapping_travel_m_ > config_.window_m) since_kidnapping_.reset();
    return;
  }
  kidnapping_travel_m_ = local_.travel_m();
  since_kidnapping_ = local_;
  since_kidnapping_->clear();
  since_kidnapping_->observe(observations, field_);
}

/// Returns the evidence near base only: the local map is distorted over longer distances, and the
/// position is already known.
LocalEvidence PriorMapLocaliser::nearby_evidence(const LocalTrunkMap& local) const {
  LocalEvidence around = evidence(local);
  const double reach_m = kNearby_ranges * config_.detection_range_m;
  const auto is_far = [&](const LocalTrunkMap::Trunk& trunk) {
    return trunk.p_local.norm() > reach_m || local.travel_m() - trunk.last_travel_m > reach_m;
  };
  around.trunks.erase(std::remove_if(around.trunks.begin(), around.trunks.end(), is_far),
                      around.trunks.end());
  while (!around.views.empty() && local.travel_m() - around.views.front().travel_m > reach_m) {
    around.views.pop_front();
  }
  return around;
}

void PriorMapLocaliser::track(const std::vector<ScanObservation>& observations) {
  watch_.add(tracker_.correct(observations, field_).expected);
  const TreeDetectionMonitor::Count trees = watch_.count();
  const bool judged = trees.num_trees >= kExpectedTreesMin;
  const bool trees_gone = judged && trees.num_detected < kLostFraction * trees.num_trees;
  if (local_.is_inconsistent()) {
    // Scan matching also measures the motion of a robot that is carried, or is unreliable.
    if (!scan_motion_ || trees_gone) {
      declare_lost("the surroundings changed suddenly without motion of the wheels", true);
      return;
    }
    restart_local_map();
  }
  if (trees_gone || local_.travel_m() - checked_travel_m_ >= kSearchInterval_m)
    check_present_pose(trees);
}

bool PriorMapLocaliser::is_vague(const Eigen::Matrix3d& covariance) const {
  return largest_sd_m(covariance) > std::min(kVagueSd_m, kVagueSpacings * map_.spacing_m());
}

void PriorMapLocaliser::become_vague() {
  if (!belief_) {
    belief_.emplace(map_);
    belief_->start(tracker_.T_map_base(), tracker_.covariance());
    must_be_tested_ = false;
  }
  leave_tracker();
}

void PriorMapLocaliser::leave_tracker() {
  tracking_ = false;
  search_.reset();
  watch_.clear();
  num_contradictions_ = 0;
}

/// Weighs all places of the map, if these are not too many, beside the search: base is as near to a
/// landmark as the farthest of the six nearest trunks, unless none of these is one. Along one row
/// some place of another orchard fits as well, too: one of thousands must pass `PatternEvidence`.
void PriorMapLocaliser::believe_anywhere(const std::vector<ScanObservation>& observations) {
  if (observations.size() < kTrunksMin) return;
  std::vector<double> ranges_m;
  for (const ScanObservation& s : observations) ranges_m.push_back(s.p_base.norm());
  std::nth_element(ranges_m.begin(), ranges_m.begin() + (kTrunksMin - 1), ranges_m.end());
  const double reach_m = ranges_m[kTrunksMin - 1];
  if (reach_m >= too_far_m_) return;
  belief_.emplace(map_);
  must_be_tested_ = true;
  if (belief_->start_anywhere(reach_m)) return;
  belief_.reset();
  too_far_m_ = reach_m;
}

/// Takes the place that the belief has come to, which confirms a stated start or ends it. It goes
/// on beside the tracker: what follows may tell that the place was wrong.
void PriorMapLocaliser::watch_belief(const std::vector<ScanObservation>& observations) {
  const bool is_corrected = belief_->correct(observations, field_);
  if (belief_->is_spread_out()) {
    belief_.reset();
    if (!tracking_) declare_lost("no tree was recognised for too long", false);
    return;
  }
  if (!is_corrected) return;
  if (belief_->pattern().is_elsewhere()) {
    declare_lost(
        "the trunks around fit no place of the prior map better than another orchard's would; this "
        "part may not be in it",
        false);
    return;
  }
  const WeighedPlace& place = belief_->place();
  const double at_tracker = tracking_ ? belief_->probability_at(tracker_.T_map_base()) : 0.0;
  const bool is_tested = !must_be_tested_ || belief_->pattern().is_of_map();
  const bool is_sure = place.weight >= kSure && is_tested && !is_vague(place.covariance);
  is_confirmed_ = at_tracker >= kSure;
  if (is_confirmed_) must_be_tested_ = false;
  if (at_tracker < kUnlikely && is_sure) {
    if (tracking_) ++num_lost_;
    place_at(place.T_map_base, place.covariance);
    must_be_tested_ = false;
    search_.reset();
  } else if (tracking_ && at_tracker < kUnlikely) {
    ++num_lost_;
    leave_tracker();
  }
}

PoseHypothesis PriorMapLocaliser::present_hypothesis(const HypothesisScorer& scorer) const {
  PoseHypothesis present_hypothesis;
  present_hypothesis.T_map_base = tracker_.T_map_base();
  present_hypothesis.covariance = tracker_.covariance();
  PoseHypothesis hypothesis =
      *scorer.fit(present_hypothesis, scorer.order_from(Eigen::Vector2d::Zero()));
  scorer.count_missing(hypothesis);
  return hypothesis;
}

void PriorMapLocaliser::check_present_pose(const TreeDetectionMonitor::Count& trees) {
  local_.reset_origin();
  checked_travel_m_ = local_.travel_m();
  LocalEvidence around = nearby_evidence(local_);
  if (around.trunks.size() < kTrunksMin) around = evidence(local_);
  const HypothesisScorer scorer(map_, config_, std::move(around));
  const bool enough = scorer.evidence().trunks.size() >= kTrunksMin;
  const bool judged = trees.num_trees >= kExpectedTreesMin;
  const bool trees_gone = judged && trees.num_detected < kLostFraction * trees.num_trees;
  const bool trees_there = judged && trees.num_detected >= kDetectedFraction * trees.num_trees;
  bool contradicted_since = false;
  if (since_kidnapping_) {
    since_kidnapping_->reset_origin();
    const HypothesisScorer since(map_, config_, nearby_evidence(*since_kidnapping_));
    if (since.evidence().trunks.size() >= kTrunksMin) {
      const double score = present_hypothesis(since).score;
      contradicted_since = score < -kLostLogFit;
      if (score > kLostLogFit) since_kidnapping_.reset();
    }
  }
  if (!enough && !trees_gone && !contradicted_since) return;
  // Where many trees were felled, the trunks seen before still support the position.
  const bool supported =
      enough && present_hypothesis(scorer).score >= -kLostLogFit && !contradicted_since;
  num_contradictions_ = supported ? 0 : num_contradictions_ + 1;
  if (trees_gone && !supported) {
    declare_lost(
        "only a few of the " + std::to_string(trees.num_trees) +
            " trees expected at the last place are visible: " + std::to_string(trees.num_detected),
        true);
  } else if (num_contradictions_ >= kContradictionsMin && !trees_there && !scan_motion_) {
    const double since_m =
        contradicted_since ? local_.travel_m() - kidnapping_travel_m_ : config_.window_m;
    declare_lost("the trunks of the last " + fixed_text(since_m, 0) +
                     " m contradict the estimated place" +
                     (contradicted_since ? "; the robot may have been carried before" : ""),
                 true);
  }
}

}  // namespace orchard::pose
