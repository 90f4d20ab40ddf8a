// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/landmark_outcomes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "geometry/statistics.hpp"
#include "mapping/candidate.hpp"
#include "mapping/extent/extent.hpp"
#include "mapping/pose_track.hpp"

namespace orchard::calibration {
namespace {

using detection::Label;
using mapping::Candidate;
using mapping::Landmark;
using mapping::MapperConfig;

/// Distance from the centre line at which a landmark ends [m]. The mapper reports no wider object
/// whole; a larger width comes from elsewhere.
double border_m(const Landmark& landmark, const MapperConfig& config) {
  return 0.5 * std::clamp(landmark.width_m, 0.0, config.object_width_max_m);
}

double reach_m(const Landmark& landmark, const MapperConfig& config) {
  return std::max(config.gate_m, border_m(landmark, config));
}

/// Whether a detection lies on the landmark within the errors of both.
bool fits(const Candidate& candidate, const Landmark& landmark, const Eigen::Vector2d& nearest_map,
          const MapperConfig& config) {
  Eigen::Vector2d beyond = candidate.p_map - nearest_map;
  const double distance_m = beyond.norm();
  const double inside_m = border_m(landmark, config);
  if (distance_m <= inside_m) return true;
  beyond *= (distance_m - inside_m) / distance_m;
  Eigen::Matrix2d covariance = candidate.covariance;
  const double n = std::max(0, landmark.num_observations);
  covariance(0, 0) += n * landmark.se_x_m * landmark.se_x_m;
  covariance(1, 1) += n * landmark.se_y_m * landmark.se_y_m;
  return beyond.dot(covariance.inverse() * beyond) <= config.gate_sigma * config.gate_sigma;
}

struct Near {
  int landmark = -1;
  double distance_m = 0.0;
  bool fits = false;
};

}  // namespace

LandmarkOutcomes::LandmarkOutcomes(std::vector<Landmark> landmarks, const MapperConfig& config)
    : landmarks_(std::move(landmarks)), config_(config) {
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    reach_max_m_ = std::max(reach_max_m_, reach_m(landmarks_[i], config_));
    for (const Eigen::Vector2d& p_map : mapping::centre_line(landmarks_[i])) {
      grid_.insert(static_cast<std::int32_t>(places_map_.size()), p_map);
      places_map_.push_back(p_map);
      landmark_of_place_.push_back(static_cast<int>(i));
    }
  }
}

LandmarkMatch LandmarkOutcomes::match(const Candidate& candidate, double& distance_m) const {
  std::vector<Near> near;  // by landmark, at its nearest place
  for (const std::int32_t place : grid_.near(candidate.p_map, reach_max_m_)) {
    const Eigen::Vector2d& p_map = places_map_[static_cast<std::size_t>(place)];
    const int index = landmark_of_place_[static_cast<std::size_t>(place)];
    const Landmark& landmark = landmarks_[static_cast<std::size_t>(index)];
    const double away_m = (candidate.p_map - p_map).norm();
    if (away_m > reach_m(landmark, config_)) continue;
    // The places of a landmark follow each other.
    if (near.empty() || near.back().landmark != index) near.push_back({index, away_m, false});
    near.back().distance_m = std::min(near.back().distance_m, away_m);
    near.back().fits = near.back().fits || fits(candidate, landmark, p_map, config_);
  }
  const bool any_fits = std::any_of(near.begin(), near.end(), [](const Near& n) { return n.fits; });
  LandmarkMatch match;
  std::set<Label> labels;
  distance_m = std::numeric_limits<double>::infinity();
  for (const Near& n : near) {
    if (any_fits && !n.fits) continue;
    labels.insert(landmarks_[static_cast<std::size_t>(n.landmark)].label);
    if (n.distance_m >= distance_m) continue;
    distance_m = n.distance_m;
    match.landmark = n.landmark;
  }
  match.is_doubtful = labels.size() > 1 || labels.count(Label::kUnseen) > 0;
  return match;
}

std::vector<LandmarkMatch> LandmarkOutcomes::match(const std::vector<Candidate>& scan) const {
  std::vector<LandmarkMatch> matches;
  std::vector<double> distances_m;
  std::map<int, std::size_t> nearest_at;  // detection by tree
  for (std::size_t k = 0; k < scan.size(); ++k) {
    distances_m.emplace_back();
    matches.push_back(match(scan[k], distances_m.back()));
    const LandmarkMatch& found = matches.back();
    if (found.landmark < 0 || found.is_doubtful) continue;
    if (landmarks_[static_cast<std::size_t>(found.landmark)].label != Label::kTree) continue;
    const auto [at, is_first] = nearest_at.try_emplace(found.landmark, k);
    if (is_first) continue;
    const bool is_nearer = distances_m[k] < distances_m[at->second];
    matches[is_nearer ? at->second : k] = {};
    if (is_nearer) at->second = k;
  }
  return matches;
}

std::vector<ProbabilitySample> landmark_samples(const std::vector<detection::Detections>& messages,
                                                const std::vector<pose::PoseEstimate>& trajectory,
                                                const LandmarkOutcomes& outcomes,
                                                const MapperConfig& config, int recording) {
  mapping::PoseTrack track(config.pose_gap_max_s);
  for (const pose::PoseEstimate& pose : trajectory) track.add(pose);
  const auto dense_us = static_cast<std::int64_t>(1e6 * config.deskew_pose_gap_max_s);
  std::vector<ProbabilitySample> samples;
  for (const detection::Detections& message : messages) {
    const auto T_map_base = track.at(message.utime);
    if (!T_map_base) continue;
    const bool is_dense = dense_us > 0 && track.is_dense_at(message.utime, dense_us);
    const detection::Detections placed =
        is_dense ? mapping::deskewed(message, track, *T_map_base) : message;
    const auto scan = mapping::compose(placed, *T_map_base, mapping::PoseComposition(*T_map_base),
                                       config.observation_range_max_m);
    const auto matches = outcomes.match(scan);
    for (std::size_t k = 0; k < scan.size(); ++k) {
      if (matches[k].is_doubtful) continue;
      const int index = matches[k].landmark;
      // What is learnt from is the detection as the detector sent it.
      const auto at = static_cast<std::size_t>(scan[k].detection - placed.trunks.data());
      ProbabilitySample sample{message.trunks[at], Outcome::kNeither, recording, index};
      if (index >= 0) {
        const Landmark& landmark = outcomes.landmarks()[static_cast<std::size_t>(index)];
        const bool is_tree = landmark.label == Label::kTree;
        sample.outcome = is_tree ? Outcome::kTree : Outcome::kObject;
      }
      samples.push_back(sample);
    }
  }
  return samples;
}

namespace {

detection::Label label_of(const ObservedObject& seen) {
  if (seen.is_trunk) return detection::Label::kTree;
  return seen.is_doubtful ? detection::Label::kUnseen : detection::Label::kObject;
}

}  // namespace

std::vector<mapping::Landmark> object_landmarks(const TrunkModel& model,
                                                const std::vector<TrunkObservation>& observations,
                                                int log) {
  std::vector<mapping::Landmark> landmarks;
  for (std::size_t object = 0; object < model.objects.size(); ++object) {
    const ObservedObject& seen = model.objects[object];
    if (seen.log != log || seen.observations.empty()) continue;
    if (!observations[seen.observations.front()].in_map) continue;
    mapping::Landmark landmark;
    landmark.id = static_cast<std::int32_t>(object) + 1;
    landmark.label = label_of(seen);
    landmark.num_observations = seen.num_observations;
    landmark.x_m = seen.x_m;
    landmark.y_m = seen.y_m;
    landmark.width_m = seen.median_width_m;
    double squares_x_m2 = 0.0, squares_y_m2 = 0.0;
    for (const std::size_t i : seen.observations) {
      squares_x_m2 += geometry::square(observations[i].x_m - seen.x_m);
      squares_y_m2 += geometry::square(observations[i].y_m - seen.y_m);
    }
    const double n = seen.num_observations;
    landmark.se_x_m = std::sqrt(squares_x_m2 / std::max(1.0, n - 1.0) / n);
    landmark.se_y_m = std::sqrt(squares_y_m2 / std::max(1.0, n - 1.0) / n);
    landmarks.push_back(landmark);
  }
  return landmarks;
}

}  // namespace orchard::calibration
