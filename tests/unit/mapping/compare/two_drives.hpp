// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/compare/visibility.hpp"
#include "mapping/landmark.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Uniform and normal numbers that are the same with every standard library.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double uniform(double a, double b) {
    return a + (b - a) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  double normal(double sd) {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform(0.0, 1.0);
    return sd * sum;
  }

 private:
  std::mt19937_64 engine_;
};

/// What truly stands in a block. Rows along x, in metres.
struct TrueTree {
  int row = 0, place = 0;  ///< from 0
  Eigen::Vector2d p{0, 0};
  double width_m = 0.0;
  bool stands = true;
  int id = 0;  ///< in the map that was made of it last; 0 = not mapped
};

struct Block {
  int num_rows = 10, num_places = 30;
  double row_spacing_m = 4.0, tree_spacing_m = 2.0;
  std::vector<TrueTree> trees;
};

inline Block plant_block(Dice& dice, int num_rows, int num_places, double missing = 0.08,
                         double planting_sd_m = 0.05, double width_sd_m = 0.02) {
  Block block;
  block.num_rows = num_rows;
  block.num_places = num_places;
  for (int r = 0; r < num_rows; ++r) {
    for (int k = 0; k < num_places; ++k) {
      TrueTree t;
      t.row = r;
      t.place = k;
      t.p = {k * block.tree_spacing_m + dice.normal(planting_sd_m),
             r * block.row_spacing_m + dice.normal(planting_sd_m)};
      t.width_m = std::max(0.05, 0.12 + dice.normal(width_sd_m));
      t.stands = dice.uniform(0, 1) >= missing;
      block.trees.push_back(t);
    }
  }
  return block;
}

/// How a drive maps a block. The path goes down the aisles first_aisle..last_aisle in turn (aisle k
/// lies before row k) and round the headlands.
struct Drive {
  int first_aisle = 0, last_aisle = 10;
  double along_min_m = -3.0, along_max_m = 61.0;
  double reach_m = 5.5;
  double rate = 0.6;  ///< that an observation finds a tree in reach
  double position_sd_m = 0.03, width_sd_m = 0.006, bend_m = 0.05;
  geometry::Pose2 T_map_block;  ///< the drive's frame
};

/// A drive through every aisle of a block planted with so many rows and places.
inline Drive whole_drive(int num_rows, int num_places) {
  Drive drive;
  drive.last_aisle = num_rows;
  drive.along_max_m = 2.0 * num_places + 1.0;
  return drive;
}

struct DrivenMap {
  std::vector<Landmark> landmarks;
  std::vector<pose::PoseEstimate> trajectory;
  std::vector<int> tree_of;  ///< index into the block, per landmark
};

/// What a drive of its map saw. By default of more reach than drives truly have: how far they saw
/// is for the map to tell.
inline DetectionMap view_of(const DrivenMap& map, double reach_m = 8.0) {
  SensorView view;
  view.reach_m = reach_m;
  return DetectionMap(map.landmarks, {map.trajectory}, view);
}

/// A place of the block as the drive's map has it: in the drive's frame, bent slowly by its error.
inline Eigen::Vector2d bent(const Drive& drive, double phase_rad, const Eigen::Vector2d& p) {
  return transform(
      drive.T_map_block,
      p + drive.bend_m * Eigen::Vector2d(std::sin(0.07 * p.y() + phase_rad),
                                         std::sin(0.06 * p.x() + 0.1 * p.y() + phase_rad)));
}

/// The landmark of a tree that was seen `num_observations` times, with the drive's noise. `p` is
/// its place in the drive's frame.
inline Landmark mapped_tree(const TrueTree& tree, const Eigen::Vector2d& p, int id,
                            int num_observations, const Drive& drive, Dice& dice) {
  Landmark l;
  l.id = id;
  l.label = detection::Label::kTree;
  l.num_observations = num_observations;
  const Eigen::Vector2d noise_m(dice.normal(drive.position_sd_m), dice.normal(drive.position_sd_m));
  l.x_m = p.x() + noise_m.x();
  l.y_m = p.y() + noise_m.y();
  l.se_x_m = l.se_y_m = 0.005;
  l.width_m = tree.width_m + dice.normal(drive.width_sd_m);
  l.roc_mean = 0.9;
  l.probability = 0.99;
  return l;
}

/// Simulates by observations of its own: ten per second at 1 m/s, each tree in reach is found with
/// a fixed chance unless a nearer trunk stands in the line of sight. A tree found three times or
/// more is mapped, with noise and a slow bend of the whole map.
inline DrivenMap drive_through(Block& block, const Drive& drive, Dice& dice, int first_id = 1) {
  DrivenMap map;
  std::vector<Eigen::Vector2d> path;
  const auto go = [&](const Eigen::Vector2d& to) {
    const Eigen::Vector2d from = path.empty() ? to : path.back();
    const int n = std::max(1, static_cast<int>((to - from).norm() / 0.1));
    for (int i = 1; i <= n; ++i) path.push_back(from + (to - from) * i / n);
  };
  bool forward = true;
  for (int aisle = drive.first_aisle; aisle <= drive.last_aisle; ++aisle) {
    const double y = (aisle - 0.5) * block.row_spacing_m;
    go({forward ? drive.along_min_m : drive.along_max_m, y});
    go({forward ? drive.along_max_m : drive.along_min_m, y});
    forward = !forward;
  }
  const double phase_rad = dice.uniform(0, 6.28);
  std::vector<int> num_seen(block.trees.size(), 0);
  for (std::size_t k = 0; k < path.size(); ++k) {
    pose::PoseEstimate pose;
    pose.utime = 1000000 + static_cast<std::int64_t>(k) * 100000;
    const Eigen::Vector2d p = bent(drive, phase_rad, path[k]);
    pose.x_m = p.x();
    pose.y_m = p.y();
    const Eigen::Vector2d ahead = path[std::min(k + 1, path.size() - 1)] - path[k > 0 ? k - 1 : 0];
    pose.yaw_rad = std::remainder(std::atan2(ahead.y(), ahead.x()) + drive.T_map_block.yaw_rad,
                                  6.283185307179586);
    map.trajectory.push_back(pose);
    if (k % 5 != 0) continue;  // the rest is accounted for below
    for (std::size_t i = 0; i < block.trees.size(); ++i) {
      const TrueTree& t = block.trees[i];
      const Eigen::Vector2d d = t.p - path[k];
      const double range_m = d.norm();
      if (!t.stands || range_m > drive.reach_m) continue;
      bool hidden = false;
      for (const TrueTree& o : block.trees) {
        const Eigen::Vector2d e = o.p - path[k];
        const double along = e.dot(d) / range_m;
        if (!o.stands || &o == &t || along < 0.0 || along > range_m - 0.3) continue;
        if (std::abs(e.x() * d.y() - e.y() * d.x()) / range_m < 0.5 * o.width_m) hidden = true;
      }
      if (hidden) continue;
      for (int observation = 0; observation < 5; ++observation)
        num_seen[i] += dice.uniform(0, 1) < drive.rate;
    }
  }
  int id = first_id;
  for (std::size_t i = 0; i < block.trees.size(); ++i) {
    TrueTree& t = block.trees[i];
    t.id = 0;
    if (!t.stands || num_seen[i] < 3) continue;
    t.id = id++;
    map.landmarks.push_back(
        mapped_tree(t, bent(drive, phase_rad, t.p), t.id, num_seen[i], drive, dice));
    map.tree_of.push_back(static_cast<int>(i));
  }
  return map;
}

}  // namespace orchard::mapping
