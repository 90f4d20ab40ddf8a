// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>
#include <set>

#include "experiments/changed_block.hpp"
#include "experiments/two_map_trials.hpp"
#include "geometry/rigid_fit2.hpp"
#include "mapping/compare/map_merging.hpp"

namespace orchard::trials {
namespace {

using Eigen::Vector2d;

constexpr double kHalfTurn_rad = 3.14159265358979323846;
constexpr double kWrong_m = 0.5;  ///< an alignment that puts a tree farther off is wrong

/// How the block was planted, and which alleys each robot drove.
struct Case {
  const char* name;
  double planting_sd_m, width_sd_m, missing;
  int last_of_first, first_of_second, last_of_second, first_of_third;
  bool is_overlapping;
  bool any_place = true;  ///< else all frames agree within a metre and a degree
};

constexpr Case kCases[] = {
    {"three robots, two rows in common", 0.05, 0.02, 0.08, 4, 3, 7, 6, true},
    {"three robots, one alley in common", 0.05, 0.02, 0.08, 3, 3, 7, 7, true},
    {"planted to a centimetre, widths 5 mm", 0.01, 0.005, 0.08, 4, 3, 7, 6, true},
    {"like a chessboard, none missing", 0.0, 0.0, 0.0, 4, 3, 7, 6, true},
    {"one frame, one alley in common", 0.05, 0.02, 0.08, 3, 3, 7, 7, true, false},
    {"one frame, planted to a centimetre", 0.01, 0.005, 0.08, 3, 3, 7, 7, true, false},
    {"nothing in common", 0.05, 0.02, 0.08, 2, 5, 6, 9, false},
    {"nothing in common, planted to a centimetre", 0.01, 0.005, 0.08, 2, 5, 6, 9, false},
    {"nothing in common, like a chessboard", 0.0, 0.0, 0.0, 2, 5, 6, 9, false},
    {"one frame, nothing in common", 0.05, 0.02, 0.08, 2, 5, 6, 9, false, false},
    {"one frame, nothing in common, like a chessboard", 0.0, 0.0, 0.0, 2, 5, 6, 9, false, false},
};

struct Score {
  int num_merged = 0, num_refused = 0, num_wrong = 0;
  int num_trees = 0, num_twice = 0, num_lost = 0, num_ids_lost = 0;
  double sum_m2 = 0.0, worst_m = 0.0;
};

/// Robots see the block from the side of their own frame.
DrivenMap drive_of(Block& block, int robot, const Case& c, Dice& dice) {
  Drive drive;
  if (robot == 0) {
    drive.last_alley = c.last_of_first;
  } else if (robot == 1) {
    drive.first_alley = c.first_of_second;
    drive.last_alley = c.last_of_second;
    drive.T_map_block = {dice.uniform(-50, 50), dice.uniform(-50, 50), kHalfTurn_rad};
  } else {  // by wheels and trunks alone: bent more
    drive.first_alley = c.first_of_third;
    drive.bend_m = 0.12;
    drive.T_map_block = {dice.uniform(-50, 50), dice.uniform(-50, 50),
                         dice.uniform(-kHalfTurn_rad, kHalfTurn_rad)};
  }
  if (!c.any_place) {
    drive.T_map_block = {dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(-0.017, 0.017)};
  }
  return drive_through(block, drive, dice, 1000 * (robot + 1));
}

double error_m(const MapAlignment& alignment, const DrivenMap& whole_frame, const DrivenMap& b) {
  std::map<int, Vector2d> place;
  for (std::size_t i = 0; i < whole_frame.landmarks.size(); ++i) {
    place[whole_frame.tree_of[i]] = {whole_frame.landmarks[i].x_m, whole_frame.landmarks[i].y_m};
  }
  double worst_m = 0.0;
  int num = 0;
  for (std::size_t j = 0; j < b.landmarks.size(); ++j) {
    const auto found = place.find(b.tree_of[j]);
    if (found == place.end()) continue;
    ++num;
    const Vector2d p(b.landmarks[j].x_m, b.landmarks[j].y_m);
    worst_m = std::max(worst_m, (transform(alignment.T_a_b, p) - found->second).norm());
  }
  return num == 0 ? 1e9 : worst_m;  // nothing in common can only be laid wrongly
}

void judge(const Block& block, const MergedMap& merged, const std::map<std::int32_t, int>& tree_of,
           const DrivenMap& first, const std::set<int>& mapped, Score& score) {
  std::map<int, int> num_of_tree;
  std::vector<Vector2d> true_m, found_m;
  for (const Landmark& l : merged.landmarks) {
    const int tree = tree_of.at(l.id);
    if (++num_of_tree[tree] > 1) continue;
    true_m.push_back(block.trees[static_cast<std::size_t>(tree)].p);
    found_m.push_back({l.x_m, l.y_m});
  }
  score.num_trees += static_cast<int>(mapped.size());
  for (const int tree : mapped) {
    score.num_twice += num_of_tree[tree] > 1;
    score.num_lost += num_of_tree[tree] == 0;
  }
  for (std::size_t i = 0; i < first.landmarks.size(); ++i) {
    const auto found = tree_of.find(first.landmarks[i].id);
    score.num_ids_lost += found == tree_of.end() || found->second != first.tree_of[i];
  }
  const geometry::Pose2 T = geometry::fit_rigid(true_m, found_m).T_a_b;
  double sum_m2 = 0.0;
  for (std::size_t i = 0; i < true_m.size(); ++i) {
    const double e_m = (transform(T, found_m[i]) - true_m[i]).norm();
    sum_m2 += e_m * e_m / static_cast<double>(true_m.size());
    score.worst_m = std::max(score.worst_m, e_m);
  }
  score.sum_m2 += sum_m2;
}

void run_case(const Case& c, std::uint64_t seed, Score& score) {
  Dice dice(seed);
  Block block = plant_block(dice, 10, 30, c.missing, c.planting_sd_m, c.width_sd_m);
  std::vector<DrivenMap> maps;
  for (int robot = 0; robot < 3; ++robot) maps.push_back(drive_of(block, robot, c, dice));
  SensorView view;
  view.reach_m = 8.0;
  MergedMap merged{maps[0].landmarks, 1};
  DrivenMap whole = maps[0];
  std::vector<std::vector<pose::PoseEstimate>> ways{maps[0].trajectory};
  std::map<std::int32_t, int> tree_of;
  std::set<int> mapped(maps[0].tree_of.begin(), maps[0].tree_of.end());
  for (std::size_t i = 0; i < whole.landmarks.size(); ++i) {
    tree_of[whole.landmarks[i].id] = whole.tree_of[i];
  }
  MapAlignmentConfig config;
  config.any_place = c.any_place;
  for (std::size_t k = 1; k < maps.size(); ++k) {
    const DrivenMap& b = maps[k];
    const MapAlignment alignment =
        align_maps(whole.landmarks, b.landmarks, DetectionMap(whole.landmarks, ways, view),
                   view_of(b), config);
    if (alignment.status != AlignmentStatus::kAligned) {
      ++score.num_refused;
      if (c.is_overlapping && c.missing > 0.0) {
        std::printf("  seed %llu, map %zu refused: %s\n", static_cast<unsigned long long>(seed),
                    k + 1, alignment.reason.c_str());
      }
      return;
    }
    if (error_m(alignment, whole, b) > kWrong_m) {
      ++score.num_wrong;
      std::printf("  seed %llu, map %zu laid WRONGLY: %zu pairs, odds %.1f, rival %.2f m off\n",
                  static_cast<unsigned long long>(seed), k + 1, alignment.pairs.size(),
                  alignment.log_odds, alignment.rival_offset_m);
      return;
    }
    const std::vector<MergedId> ids = merge_into(merged, b.landmarks, alignment);
    whole.landmarks = merged.landmarks;
    for (std::size_t j = 0; j < ids.size(); ++j) {
      tree_of.insert({ids[j].now, b.tree_of[j]});  // one that is wrongly united is lost
      mapped.insert(b.tree_of[j]);
    }
    whole.tree_of.clear();
    for (const Landmark& l : whole.landmarks) whole.tree_of.push_back(tree_of.at(l.id));
    std::vector<pose::PoseEstimate> way = b.trajectory;
    for (pose::PoseEstimate& pose : way) {
      const Vector2d p = transform(alignment.T_a_b, {pose.x_m, pose.y_m});
      pose.x_m = p.x();
      pose.y_m = p.y();
      pose.yaw_rad = std::remainder(pose.yaw_rad + alignment.T_a_b.yaw_rad, 2.0 * kHalfTurn_rad);
    }
    ways.push_back(std::move(way));
  }
  ++score.num_merged;
  judge(block, merged, tree_of, maps[0], mapped, score);
}

}  // namespace

bool run_merge(const Seeds& seeds) {
  bool is_reached = true;
  for (const Case& c : kCases) {
    Score score;
    for (std::uint64_t seed = seeds.first; seed <= seeds.last; ++seed) run_case(c, seed, score);
    std::printf("%s: %d merged, %d refused, %d wrong", c.name, score.num_merged, score.num_refused,
                score.num_wrong);
    if (score.num_merged > 0) {
      std::printf("; of %d trees %d twice, %d lost, %d ids lost; error %.0f mm RMS, %.0f at most",
                  score.num_trees, score.num_twice, score.num_lost, score.num_ids_lost,
                  1e3 * std::sqrt(score.sum_m2 / score.num_merged), 1e3 * score.worst_m);
    }
    std::printf("\n");
    is_reached =
        is_reached && score.num_wrong + score.num_twice + score.num_lost + score.num_ids_lost == 0;
  }
  return is_reached;
}

}  // namespace orchard::trials
