// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/graph.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/pose2.hpp"

namespace orchard::pose {

using geometry::rotation;
namespace {

// Min standard deviation of a landmark [m]; physical: bark is rough by so much.
constexpr double kLandmarkSdMin_m = 0.02;

template <class Observations>
auto find_observation(Observations& observations, int landmark) {
  return std::find_if(observations.begin(), observations.end(),
                      [&](const SlamObservation& s) { return s.landmark == landmark; });
}

/// Adds one observation of a landmark, by a keyframe at T, to its position in map. `noise`: its
/// variance over what it claims.
void add_to(PositionSum& sum, const SlamObservation& observation, const Eigen::Vector3d& T,
            double noise) {
  const Eigen::Matrix2d R = rotation(T.z());
  const Eigen::Matrix2d W = R * (noise * observation.covariance()).inverse() * R.transpose();
  sum.information += W;
  sum.information_m += W * (R * observation.position() + T.head<2>());
}

}  // namespace

Eigen::Vector2d SlamObservation::position() const { return information.inverse() * information_m; }

Eigen::Matrix2d SlamObservation::covariance() const {
  return information.inverse() + floor_sd_m * floor_sd_m * Eigen::Matrix2d::Identity();
}

std::vector<SlamObservation>& ObservationList::edit() {
  if (memory_ != nullptr) {
    own_.assign(begin(), end());
    memory_ = nullptr;
  }
  return own_;
}

void ObservationList::keep(SlamObservationStore& memory) {
  if (memory_ != nullptr || own_.empty()) return;
  kept_ = memory.keep(own_);
  if (kept_.first == nullptr) return;
  memory_ = &memory;
  std::vector<SlamObservation>().swap(own_);  // what is only assigned to keeps its room
}

Eigen::Matrix2d SlamLandmark::covariance() const {
  const Eigen::Matrix2d floor = kLandmarkSdMin_m * kLandmarkSdMin_m * Eigen::Matrix2d::Identity();
  if (information.determinant() <= 0.0) return floor + Eigen::Matrix2d::Identity();
  return information.inverse() + floor;
}

double SlamLandmark::width_sd_m() const {
  return width_information > 0.0 ? 1.0 / std::sqrt(width_information) : 1.0;
}

void SlamLandmark::add_width(double observed_m, double sd_m) {
  const double added = 1.0 / (sd_m * sd_m);
  width_m = (width_m * width_information + observed_m * added) / (width_information + added);
  width_information += added;
}

void SlamGraph::add_observation(int keyframe, int landmark, const Eigen::Vector2d& p_base,
                                const Eigen::Matrix2d& covariance, double floor_sd_m) {
  std::vector<SlamObservation>& observations = keyframes[keyframe].observations.edit();
  auto observation = find_observation(observations, landmark);
  if (observation == observations.end()) {
    SlamObservation fresh;
    fresh.landmark = landmark;
    observations.push_back(fresh);
    observation = std::prev(observations.end());
    landmarks[landmark].keyframes.push_back(keyframe);
  }
  const Eigen::Matrix2d information = covariance.inverse();
  observation->information += information;
  observation->information_m += information * p_base;
  observation->floor_sd_m = std::max(observation->floor_sd_m, floor_sd_m);
  ++observation->num_scans;
  landmarks[landmark].seen_m = std::max(landmarks[landmark].seen_m, p_base.norm());
}

void SlamGraph::drop_rare_observations(double num_scans) {
  std::vector<int> rare;
  for (const SlamObservation& s : keyframes.back().observations) {
    if (s.num_scans < num_scans) rare.push_back(s.landmark);
  }
  for (const int l : rare) {
    if (landmarks[l].keyframes.size() < 2) {
      drop(l);
      continue;
    }
    landmarks[l].keyframes.pop_back();
    std::vector<SlamObservation>& observations = keyframes.back().observations.edit();
    observations.erase(find_observation(observations, l));
  }
}

void SlamGraph::drop(int landmark) {
  SlamLandmark& l = landmarks[landmark];
  older.forget(landmark);
  for (const int k : l.keyframes) {
    std::vector<SlamObservation>& observations = keyframes[k].observations.edit();
    const auto observation = find_observation(observations, landmark);
    if (observation != observations.end()) observations.erase(observation);
  }
  l.keyframes.clear();
  l.keyframes.shrink_to_fit();
  l.alive = l.confirmed = false;
}

void SlamGraph::merge(int landmark, int into) {
  SlamLandmark& from = landmarks[landmark];
  SlamLandmark& to = landmarks[into];
  older.forget(landmark);
  older.forget(into);
  if (merges) {
    LandmarkMerge merge{landmark, into, from, to, {}};
    for (const int k : from.keyframes) merge.observations_were.push_back(keyframes[k].observations);
    merges->push_back(std::move(merge));
  }
  for (const int k : from.keyframes) {
    std::vector<SlamObservation>& observations = keyframes[k].observations.edit();
    const auto observation = find_observation(observations, landmark);
    const auto same = find_observation(observations, into);
    if (same == observations.end()) {
      observation->landmark = into;
    } else {
      same->information += observation->information;
      same->information_m += observation->information_m;
      same->num_scans += observation->num_scans;
      observations.erase(observation);
    }
  }
  std::vector<int> all;
  std::set_union(to.keyframes.begin(), to.keyframes.end(), from.keyframes.begin(),
                 from.keyframes.end(), std::back_inserter(all));
  to.keyframes = std::move(all);
  const double information = to.width_information + from.width_information;
  if (information > 0.0) {
    to.width_m =
        (to.width_m * to.width_information + from.width_m * from.width_information) / information;
  }
  to.width_information = information;
  to.seen_m = std::max(to.seen_m, from.seen_m);
  to.num_misses = std::min(to.num_misses, from.num_misses);
  to.confirmed = to.confirmed || from.confirmed;
  from.keyframes.clear();
  from.alive = from.confirmed = false;
}

void SlamGraph::undo_merges() {
  if (!merges) return;
  for (auto merge = merges->rbegin(); merge != merges->rend(); ++merge) {
    older.forget(merge->from);
    older.forget(merge->into);
    for (std::size_t i = 0; i < merge->observations_were.size(); ++i) {
      keyframes[merge->from_was.keyframes[i]].observations = std::move(merge->observations_were[i]);
    }
    landmarks[merge->from] = std::move(merge->from_was);
    landmarks[merge->into] = std::move(merge->into_was);
  }
  merges->clear();
}

bool SlamGraph::co_observed(int a, int b) const {
  const std::vector<int>& of_a = landmarks[a].keyframes;
  const std::vector<int>& of_b = landmarks[b].keyframes;
  auto i = of_a.begin();
  auto j = of_b.begin();
  while (i != of_a.end() && j != of_b.end()) {
    if (*i == *j) return true;
    *i < *j ? ++i : ++j;
  }
  return false;
}

const OlderSums::Sum& SlamGraph::older_sum(int landmark) {
  OlderSums::Sum& sum = older.of(landmark);
  const std::vector<int>& observed_by = landmarks[landmark].keyframes;
  for (; sum.num_keyframes < observed_by.size(); ++sum.num_keyframes) {
    const int k = observed_by[sum.num_keyframes];
    if (k >= older.first()) break;
    add_to(sum, *find_observation(keyframes[k].observations, landmark), keyframes[k].T_map_base,
           observation_noise);
  }
  return sum;
}

void SlamGraph::update_landmark(int landmark, bool update_position) {
  SlamLandmark& l = landmarks[landmark];
  const OlderSums::Sum& older_keyframes = older_sum(landmark);
  PositionSum sum = older_keyframes;
  for (std::size_t i = older_keyframes.num_keyframes; i < l.keyframes.size(); ++i) {
    const Keyframe& keyframe = keyframes[l.keyframes[i]];
    add_to(sum, *find_observation(keyframe.observations, landmark), keyframe.T_map_base,
           observation_noise);
  }
  l.information = sum.information;
  if (update_position && sum.information.determinant() > 0.0)
    l.p_map = sum.information.inverse() * sum.information_m;
}

void SlamGraph::update_landmarks(const std::vector<Update>& updates) {
  std::vector<PositionSum> sums(landmarks.size());
  for (const Keyframe& keyframe : keyframes) {
    for (const SlamObservation& o : keyframe.observations) {
      if (updates[o.landmark] == Update::kNone) continue;
      add_to(sums[o.landmark], o, keyframe.T_map_base, observation_noise);
    }
  }
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    if (updates[l] == Update::kNone) continue;
    const PositionSum& sum = sums[l];
    landmarks[l].information = sum.information;
    if (updates[l] == Update::kPosition && sum.information.determinant() > 0.0) {
      landmarks[l].p_map = sum.information.inverse() * sum.information_m;
    }
  }
}

}  // namespace orchard::pose
