// SPDX-License-Identifier: BSD-3-Clause
#include "system/real_recordings/tree_repeat.hpp"
#include "geometry/pose2.hpp"
#include "geometry/rigid_fit2.hpp"
#include "geometry/statistics.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "system/real_recordings/free_standing.hpp"

namespace orchard::test {
namespace {

constexpr double kReach_m = 5.0;
constexpr double kOfOneTree_m = 1.0;
constexpr double kSamePlace_m = 0.5;
constexpr std::size_t kObservationsMin = 10;

std::vector<Eigen::Vector2d> tree_places(const std::vector<mapping::Landmark>& map) {
  std::vector<Eigen::Vector2d> places;
  for (const mapping::Landmark& l : map) {
    if (l.label != detection::Label::kTree ||
        l.num_observations < static_cast<int>(kObservationsMin)) {
      continue;
    }
    places.emplace_back(l.x_m, l.y_m);
  }
  return places;
}

int num_within(const std::vector<Eigen::Vector2d>& places, const Eigen::Vector2d& p,
               double distance_m) {
  return static_cast<int>(
      std::count_if(places.begin(), places.end(),
                    [&](const Eigen::Vector2d& q) { return (q - p).norm() < distance_m; }));
}

Eigen::Vector2d nearest(const std::vector<Eigen::Vector2d>& places, const Eigen::Vector2d& p) {
  return *std::min_element(places.begin(), places.end(),
                           [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
                             return (a - p).norm() < (b - p).norm();
                           });
}

/// Landmarks of clear trees that have exactly one.
std::vector<Eigen::Vector2d> clear_places(const std::vector<ClearTree>& clear_trees,
                                          const std::vector<Eigen::Vector2d>& places) {
  std::vector<Eigen::Vector2d> clear;
  for (const ClearTree& tree : clear_trees) {
    const Eigen::Vector2d p(tree.x_m, tree.y_m);
    if (num_within(places, p, kSamePlace_m) == 1) clear.push_back(nearest(places, p));
  }
  return clear;
}

std::map<std::int64_t, Eigen::Vector3d> by_time(const std::vector<pose::PoseEstimate>& path) {
  std::map<std::int64_t, Eigen::Vector3d> poses;
  for (const pose::PoseEstimate& p : path) poses[p.utime] = {p.x_m, p.y_m, p.yaw_rad};
  return poses;
}

/// T_first_second by the places of the two paths at the same times, by least squares.
Eigen::Vector3d lay_upon(const MappedDrive& first, const MappedDrive& second) {
  const auto a = by_time(first.trajectory);
  std::vector<Eigen::Vector2d> p_first, p_second;
  for (const pose::PoseEstimate& p : second.trajectory) {
    const auto then = a.find(p.utime);
    if (then == a.end()) continue;
    p_second.emplace_back(p.x_m, p.y_m);
    p_first.push_back(then->second.head<2>());
  }
  if (p_first.empty()) return Eigen::Vector3d::Zero();
  return geometry::fit_rigid(p_first, p_second).T_a_b.vector();
}

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[160];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

}  // namespace

double TreeScatter::median_m() const { return geometry::median(medians_m); }

TreeScatter tree_scatter(const std::vector<io::SensorMessage>& recording, const MappedDrive& drive,
                         const std::vector<ClearTree>& clear_trees) {
  const std::vector<Eigen::Vector2d> places = tree_places(drive.map);
  const std::vector<Eigen::Vector2d> clear = clear_places(clear_trees, places);
  const auto poses = by_time(drive.trajectory);
  std::vector<std::vector<double>> distances_m(clear.size());
  for (const io::SensorMessage& message : recording) {
    const auto* scan = std::get_if<laser::Scan>(&message);
    if (scan == nullptr) continue;
    const auto T_map_base = poses.find(scan->utime);
    if (T_map_base == poses.end()) continue;
    std::vector<Eigen::Vector2d> seen;
    for (const Eigen::Vector2d& p : free_standing(*scan)) {
      if (p.norm() <= kReach_m) seen.push_back(geometry::transform(T_map_base->second, p));
    }
    if (seen.empty()) continue;
    for (std::size_t i = 0; i < clear.size(); ++i) {
      const double away_m = (nearest(seen, clear[i]) - clear[i]).norm();
      if (away_m < kOfOneTree_m) distances_m[i].push_back(away_m);
    }
  }
  TreeScatter scatter;
  for (std::vector<double>& d : distances_m) {
    if (d.size() < kObservationsMin) continue;
    std::sort(d.begin(), d.end());
    scatter.medians_m.push_back(geometry::median(d));
    scatter.num_observations += static_cast<int>(d.size());
  }
  std::sort(scatter.medians_m.begin(), scatter.medians_m.end());
  return scatter;
}

SameTrees same_trees(const std::vector<ClearTree>& clear_trees, const MappedDrive& first,
                     const MappedDrive& second) {
  const Eigen::Vector3d T_first_second = lay_upon(first, second);
  std::vector<Eigen::Vector2d> laid;
  for (const Eigen::Vector2d& p : tree_places(second.map)) {
    laid.push_back(geometry::transform(T_first_second, p));
  }
  SameTrees same;
  const std::vector<Eigen::Vector2d> places = tree_places(first.map);
  for (const Eigen::Vector2d& p : clear_places(clear_trees, places)) {
    same.num_extra +=
        std::max(0, num_within(laid, p, kOfOneTree_m) - num_within(places, p, kOfOneTree_m));
    if (num_within(laid, p, kSamePlace_m) != 1) {
      ++same.num_missing;
      continue;
    }
    ++same.num_in_both;
    same.distances_m.push_back((nearest(laid, p) - p).norm());
  }
  std::sort(same.distances_m.begin(), same.distances_m.end());
  return same;
}

std::string report(const TreeScatter& scatter) {
  if (scatter.medians_m.empty()) return "scatter of a tree's observations: no clear tree\n";
  return text("scatter of a tree's observations: median %.3f m, most %.3f m (%zu trees, %d)\n",
              scatter.median_m(), scatter.medians_m.back(), scatter.medians_m.size(),
              scatter.num_observations);
}

std::string report(const SameTrees& same) {
  std::string all =
      text("clear trees of the other map: one landmark for %d of %d, %d beside them\n",
           same.num_in_both, same.num_in_both + same.num_missing, same.num_extra);
  if (!same.distances_m.empty()) {
    all += text("distance to it: median %.3f m, most %.3f m\n", geometry::median(same.distances_m),
                same.distances_m.back());
  }
  return all;
}

}  // namespace orchard::test
