// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/walkers.hpp"

#include <algorithm>
#include <cstddef>
#include <tuple>

#include "mapping/existence/legs.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Max speed of a leg: a swinging leg moves at twice the speed of a brisk walk of 1.5 m/s.
constexpr double kLegSpeed_mps = 3.0;
/// Max duration of a step [us], during which a foot rests.
constexpr std::int64_t kStep_us = 600'000;
/// Distance between the footprints of a brisk walk of 1.5 m/s, two steps a second.
constexpr double kStepLength_m = 0.75;
/// A leg not observed for half a step is lost [us].
constexpr std::int64_t kLost_us = kStep_us / 2;
/// A walked path has at least this many positions, and the distance of its ends is at least this
/// fraction of its length.
constexpr std::size_t kPathMin = 5;
constexpr double kStraight = 0.8;
/// Landmarks with this many observations do exist.
constexpr int kStandsObservations = 30;

constexpr int kBothSides = detection::kOccludedLeft | detection::kOccludedRight;

struct Path {
  std::vector<std::int64_t> utimes;
  std::vector<Vector2d> places;
  double length_m = 0.0;

  void add(std::int64_t utime, const Vector2d& p_map) {
    if (!places.empty()) length_m += (p_map - places.back()).norm();
    utimes.push_back(utime);
    places.push_back(p_map);
  }
  bool is_walked() const {
    const double apart_m = (places.back() - places.front()).norm();
    return places.size() >= kPathMin && apart_m > kStanceMax_m && apart_m > kStraight * length_m;
  }
};

/// Appends the positions of one scan to the paths within reach, nearest first; the others start new
/// paths.
void follow(std::vector<Path>& paths, std::int64_t utime, const std::vector<Vector2d>& places) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const double reach_m =
        kLegSpeed_mps * 1e-6 * static_cast<double>(utime - paths[i].utimes.back());
    for (std::size_t k = 0; k < places.size(); ++k) {
      const double way_m = (places[k] - paths[i].places.back()).norm();
      if (way_m <= reach_m) pairs.emplace_back(way_m, i, k);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  std::vector<char> is_followed(paths.size(), 0), is_taken(places.size(), 0);
  for (const auto& [way_m, i, k] : pairs) {
    if (is_followed[i] || is_taken[k]) continue;
    is_followed[i] = is_taken[k] = 1;
    paths[i].add(utime, places[k]);
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    if (!is_taken[k]) paths.emplace_back().add(utime, places[k]);
  }
}

}  // namespace

WalkerTracks::WalkerTracks(const MapState& map) : map_(map) {
  const ObservationStore& all = map.observations;
  const ChunkedArray<std::int32_t> landmark_of = map.landmark_of_observation();
  std::vector<Path> paths;
  const auto end = [&](std::int64_t lost_before_us) {
    const auto is_lost = [&](const Path& path) {
      if (path.utimes.back() >= lost_before_us) return false;
      if (path.is_walked()) {
        for (std::size_t i = 0; i < path.places.size(); ++i) {
          steps_.push_back({path.utimes[i], path.places[i]});
        }
      }
      return true;
    };
    paths.erase(std::remove_if(paths.begin(), paths.end(), is_lost), paths.end());
  };
  for (std::int32_t scan = 0; scan < all.num_scans(); ++scan) {
    const std::int64_t utime = all.pose(scan).utime;
    std::vector<Vector2d> places;
    for (std::int32_t k = all.first_of(scan); k < all.first_of(scan + 1); ++k) {
      const std::int32_t landmark = landmark_of[static_cast<std::size_t>(k)];
      const bool stands = landmark >= 0 && map.landmarks[landmark].num_all >= kStandsObservations;
      // The visible part of an occluded object moves with the robot, so it must be as wide as a
      // leg.
      const double least_m = all[k].occlusion == 0 ? 0.0 : kLegMin_m;
      if (stands || all[k].occlusion == kBothSides || all[k].width_m < least_m ||
          all[k].width_m > kLegMax_m) {
        continue;
      }
      places.push_back(all.p_map(k));
    }
    end(utime - kLost_us);
    follow(paths, utime, places);
  }
  end(INT64_MAX);
  std::stable_sort(steps_.begin(), steps_.end(),
                   [](const Step& a, const Step& b) { return a.utime < b.utime; });
}

bool WalkerTracks::passes(const Step& seen) const {
  const auto first =
      std::lower_bound(steps_.begin(), steps_.end(), seen.utime - kStep_us,
                       [](const Step& step, std::int64_t utime) { return step.utime < utime; });
  for (auto step = first; step != steps_.end() && step->utime <= seen.utime + kStep_us; ++step) {
    if ((step->p_map - seen.p_map).norm() <= kStepLength_m) return true;
  }
  return false;
}

bool WalkerTracks::is_footprint(const LandmarkRecord& r) const {
  if (steps_.empty() || r.num_all >= kStandsObservations) return false;
  const ObservationStore& all = map_.observations;
  const std::vector<std::int32_t> seen = all.newest_of(r.last_observation, kStandsObservations);
  return std::all_of(seen.begin(), seen.end(), [&](std::int32_t k) {
    return passes({all.pose(all[k].scan).utime, all.p_map(k)});
  });
}

}  // namespace orchard::mapping
