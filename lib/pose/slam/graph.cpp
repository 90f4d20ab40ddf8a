// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/graph.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "pose/planar.hpp"

namespace orchard::pose {
namespace {

// However often a landmark was seen, the map around it is not known better than this.
constexpr double kLandmarkFloorM = 0.02;

std::vector<SlamSighting>::iterator find_sighting(Keyframe& keyframe, int landmark) {
  return std::find_if(keyframe.sightings.begin(), keyframe.sightings.end(),
                      [&](const SlamSighting& s) { return s.landmark == landmark; });
}

}  // namespace

Eigen::Vector2d SlamSighting::position() const { return information.inverse() * information_m; }

Eigen::Matrix2d SlamSighting::covariance() const {
  return information.inverse() + floor_sd_m * floor_sd_m * Eigen::Matrix2d::Identity();
}

Eigen::Matrix2d SlamLandmark::covariance() const {
  const Eigen::Matrix2d floor = kLandmarkFloorM * kLandmarkFloorM * Eigen::Matrix2d::Identity();
  if (information.determinant() <= 0.0) return floor + Eigen::Matrix2d::Identity();
  return information.inverse() + floor;
}

void SlamGraph::add_sighting(int keyframe, int landmark, const Eigen::Vector2d& p_base,
                             const Eigen::Matrix2d& covariance, double floor_sd_m) {
  Keyframe& k = keyframes[keyframe];
  auto sighting = find_sighting(k, landmark);
  if (sighting == k.sightings.end()) {
    SlamSighting fresh;
    fresh.landmark = landmark;
    k.sightings.push_back(fresh);
    sighting = std::prev(k.sightings.end());
    landmarks[landmark].keyframes.push_back(keyframe);
  }
  const Eigen::Matrix2d information = covariance.inverse();
  sighting->information += information;
  sighting->information_m += information * p_base;
  sighting->floor_sd_m = std::max(sighting->floor_sd_m, floor_sd_m);
  ++sighting->num_scans;
}

void SlamGraph::drop_rare_sightings(double num_scans) {
  std::vector<int> rare;
  for (const SlamSighting& s : keyframes.back().sightings) {
    if (s.num_scans < num_scans) rare.push_back(s.landmark);
  }
  for (const int l : rare) {
    if (landmarks[l].keyframes.size() < 2) {
      drop(l);
      continue;
    }
    landmarks[l].keyframes.pop_back();
    keyframes.back().sightings.erase(find_sighting(keyframes.back(), l));
  }
}

void SlamGraph::drop(int landmark) {
  SlamLandmark& l = landmarks[landmark];
  for (const int k : l.keyframes) {
    const auto sighting = find_sighting(keyframes[k], landmark);
    if (sighting != keyframes[k].sightings.end()) keyframes[k].sightings.erase(sighting);
  }
  l.keyframes.clear();
  l.keyframes.shrink_to_fit();
  l.alive = l.confirmed = false;
}

void SlamGraph::merge(int landmark, int into) {
  SlamLandmark& from = landmarks[landmark];
  SlamLandmark& to = landmarks[into];
  for (const int k : from.keyframes) {
    Keyframe& keyframe = keyframes[k];
    const auto sighting = find_sighting(keyframe, landmark);
    const auto same = find_sighting(keyframe, into);
    if (same == keyframe.sightings.end()) {
      sighting->landmark = into;
    } else {
      same->information += sighting->information;
      same->information_m += sighting->information_m;
      same->num_scans += sighting->num_scans;
      keyframe.sightings.erase(sighting);
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
  to.num_misses = std::min(to.num_misses, from.num_misses);
  to.confirmed = to.confirmed || from.confirmed;
  from.keyframes.clear();
  from.alive = from.confirmed = false;
}

bool SlamGraph::seen_together(int a, int b) const {
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

void SlamGraph::replace(int landmark, bool place) {
  SlamLandmark& l = landmarks[landmark];
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d information_m = Eigen::Vector2d::Zero();
  for (const int k : l.keyframes) {
    const auto sighting = find_sighting(keyframes[k], landmark);
    const Eigen::Vector3d& T = keyframes[k].T_map_base;
    const Eigen::Matrix2d R = rotation(T.z());
    const Eigen::Matrix2d W = R * sighting->covariance().inverse() * R.transpose();
    information += W;
    information_m += W * transform(T, sighting->position());
  }
  l.information = information;
  if (place && information.determinant() > 0.0) l.p_map = information.inverse() * information_m;
}

}  // namespace orchard::pose
