// SPDX-License-Identifier: BSD-3-Clause
// PriorMapLocaliser while tracking: checks the present position and gives it up.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "geometry/pose2.hpp"
#include "pose/prior_map/decision_thresholds.hpp"
#include "pose/prior_map/prior_map_localiser.hpp"
#include "text/number_text.hpp"

namespace orchard::pose {
namespace {

/// Min distance and rotation between a rival and the present position.
constexpr double kRivalDistance_m = 1.0;
constexpr double kRivalRotation_rad = 0.3;

double largest_sd_m(const Eigen::Matrix3d& P) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(P.topLeftCorner<2, 2>(), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, axes.eigenvalues().maxCoeff()));
}

}  // namespace

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
  const double sd_m = largest_sd_m(tracker_.covariance());
  if (sd_m > std::min(kLostSd_m, kLostSpacings * map_.spacing_m())) {
    declare_lost("no tree was recognised for too long; the position uncertainty is " +
                     fixed_text(sd_m, 1) + " m",
                 false);
    return;
  }
  if (search_ && search_->step(kHypothesesPerScan)) {
    const bool is_rivalled = has_rival(search_->result());
    search_.reset();
    if (is_rivalled) {
      declare_lost(
          "the trunks around the robot fit another place much better; it may have been carried "
          "there",
          true);
      return;
    }
  }
  if (trees_gone || local_.travel_m() - checked_travel_m_ >= kSearchInterval_m)
    check_present_pose(trees);
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

bool PriorMapLocaliser::has_rival(const SearchResult& result) const {
  if (result.hypotheses.empty() || result.log_fit < kLogFitMin) return false;
  const PoseHypothesis& best = result.hypotheses.front();
  const Eigen::Vector3d apart = best.T_map_base - held_hypothesis_.T_map_base;
  const bool is_elsewhere = apart.head<2>().norm() > kRivalDistance_m ||
                            std::abs(geometry::wrap_angle_rad(apart.z())) > kRivalRotation_rad;
  return is_elsewhere && best.score > held_hypothesis_.score + kLogOddsMin;
}

void PriorMapLocaliser::start_rival_search(const LocalTrunkMap& local) {
  LocalEvidence all = evidence(local);
  if (search_ || all.trunks.size() < static_cast<std::size_t>(kTrunksMin)) return;
  held_hypothesis_ = present_hypothesis(HypothesisScorer(map_, config_, all));
  search_.emplace(map_, config_, std::move(all));
}

void PriorMapLocaliser::check_present_pose(const TreeDetectionMonitor::Count& trees) {
  local_.reset_origin();
  checked_travel_m_ = local_.travel_m();
  const auto num_enough = static_cast<std::size_t>(kTrunksMin);
  LocalEvidence around = nearby_evidence(local_);
  if (around.trunks.size() < num_enough) around = evidence(local_);
  const HypothesisScorer scorer(map_, config_, std::move(around));
  const bool enough = scorer.evidence().trunks.size() >= num_enough;
  const bool judged = trees.num_trees >= kExpectedTreesMin;
  const bool trees_gone = judged && trees.num_detected < kLostFraction * trees.num_trees;
  const bool trees_there = judged && trees.num_detected >= kDetectedFraction * trees.num_trees;
  bool contradicted_since = false;
  if (since_kidnapping_) {
    since_kidnapping_->reset_origin();
    const HypothesisScorer since(map_, config_, nearby_evidence(*since_kidnapping_));
    if (since.evidence().trunks.size() >= num_enough) {
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
  } else if (num_contradictions_ < kContradictionsMin) {
    return;
  } else if (trees_there || scan_motion_) {
    start_rival_search(contradicted_since ? *since_kidnapping_ : local_);
  } else {
    const double since_m =
        contradicted_since ? local_.travel_m() - kidnapping_travel_m_ : config_.window_m;
    declare_lost("the trunks of the last " + fixed_text(since_m, 0) +
                     " m contradict the estimated place" +
                     (contradicted_since ? "; the robot may have been carried before" : ""),
                 true);
  }
}

}  // namespace orchard::pose
