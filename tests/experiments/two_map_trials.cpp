// SPDX-License-Identifier: BSD-3-Clause
// two_map_trials MODE FIRST LAST: maps compared, numbered anew and merged over random blocks of 10
// rows of 30 trees (4 m x 2 m, 8 % missing), whose drives' observations, noise and slow bends are
// simulated without scans.
//   changes  one block before and after changes, and unchanged: what compare finds
//   ids      one block before and after changes: ids and numbers that are kept
//   merge    three robots, each in some of the rows and in a frame of its own, as one map
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <string>

#include "experiments/json_line.hpp"
#include "geometry/rigid_fit2.hpp"
#include "mapping/compare/map_comparison.hpp"
#include "mapping/compare/map_merging.hpp"
#include "mapping/compare/visibility.hpp"
#include "unit/mapping/compare/two_drives.hpp"

namespace orchard::trials {
namespace {

using namespace mapping;

/// Shares of the trees to which each happens between two days.
struct DayChanges {
  double felled = 0.05, moved = 0.05, grown = 0.05;  ///< as many are planted as were felled
};

/// What truly happened to each tree of the block, by its index; no entry: nothing. A tree that
/// moved stands half a metre to one and a half farther along its row, one that grew is 20 to 60 mm
/// wider (two standard deviations).
std::map<int, Change> change_block(Block& block, const DayChanges& fraction, Dice& dice) {
  std::map<int, Change> truth;
  int num_felled = 0;
  std::vector<int> gaps;
  for (std::size_t i = 0; i < block.trees.size(); ++i) {
    TrueTree& t = block.trees[i];
    const int index = static_cast<int>(i);
    if (!t.stands) {
      gaps.push_back(index);
      continue;
    }
    const double die = dice.uniform(0, 1);
    if (die < fraction.felled) {
      t.stands = false;
      truth[index] = Change::kMissing;
      ++num_felled;
    } else if (die < fraction.felled + fraction.moved) {
      const double way_m = dice.uniform(0.5, 1.5) * (dice.uniform(0, 1) < 0.5 ? 1.0 : -1.0);
      const Eigen::Vector2d p = t.p + Eigen::Vector2d(way_m, dice.normal(0.05));
      const bool is_free = std::all_of(
          block.trees.begin(), block.trees.end(),
          [&](const TrueTree& o) { return &o == &t || !o.stands || (o.p - p).norm() > 0.4; });
      if (!is_free) continue;
      t.p = p;
      truth[index] = Change::kMoved;
    } else if (die < fraction.felled + fraction.moved + fraction.grown) {
      t.width_m += std::max(0.01, 0.04 + dice.normal(0.01));
      truth[index] = Change::kGrown;
    }
  }
  for (int planted = 0; planted < num_felled && !gaps.empty(); ++planted) {
    const auto k = static_cast<std::size_t>(dice.uniform(0, 1) * gaps.size());
    const int index = gaps[k];
    gaps.erase(gaps.begin() + static_cast<std::ptrdiff_t>(k));
    TrueTree& t = block.trees[static_cast<std::size_t>(index)];
    const bool is_free =
        std::all_of(block.trees.begin(), block.trees.end(),
                    [&](const TrueTree& o) { return !o.stands || (o.p - t.p).norm() > 0.4; });
    if (!is_free) continue;
    t.stands = true;
    truth[index] = Change::kNew;
  }
  return truth;
}

// changes

constexpr std::array<Change, 5> kKinds{Change::kMissing, Change::kNew, Change::kMoved,
                                       Change::kGrown, Change::kThinner};

struct Score {
  int num_true = 0, right = 0, wrong = 0;
};

struct Scores {
  std::array<Score, kKinds.size()> of_kind;
  int num_compared = 0, num_unaligned = 0;
};

std::size_t kind_of(Change change) {
  return static_cast<std::size_t>(std::find(kKinds.begin(), kKinds.end(), change) - kKinds.begin());
}

void judge(const DrivenMap& a, const DrivenMap& b, const std::map<int, Change>& truth,
           Scores& scores) {
  const DetectionMap view_a = view_of(a), view_b = view_of(b);
  const MapAlignment alignment =
      align_maps(a.landmarks, b.landmarks, view_a, view_b, MapAlignmentConfig{});
  if (alignment.status != AlignmentStatus::kAligned) {
    ++scores.num_unaligned;
    return;
  }
  for (const auto& [tree, change] : truth) ++scores.of_kind[kind_of(change)].num_true;
  const MapComparison comparison =
      compare_maps(a.landmarks, b.landmarks, view_a, view_b, alignment, ComparisonConfig{});
  for (const MapChange& c : comparison.changes) {
    ++scores.num_compared;
    if (c.change == Change::kUnchanged || c.change == Change::kNotSeen) continue;
    const int tree_a = c.a >= 0 ? a.tree_of[static_cast<std::size_t>(c.a)] : -1;
    const int tree_b = c.b >= 0 ? b.tree_of[static_cast<std::size_t>(c.b)] : -1;
    const auto found = truth.find(tree_a >= 0 ? tree_a : tree_b);
    const bool is_right = found != truth.end() && found->second == c.change &&
                          (tree_a < 0 || tree_b < 0 || tree_a == tree_b);
    Score& score = scores.of_kind[kind_of(c.change)];
    (is_right ? score.right : score.wrong)++;
  }
}

void run_changes(std::uint64_t first, std::uint64_t last) {
  for (const double width_sd_m : {0.004, 0.006}) {  // of each map's widths
    Scores changed, same;
    for (std::uint64_t seed = first; seed <= last; ++seed) {
      Dice dice(seed);
      Block block = plant_block(dice, 10, 30);
      Drive drive;
      drive.width_sd_m = width_sd_m;
      const DrivenMap a = drive_through(block, drive, dice);
      Drive later = drive;
      later.T_map_block = {dice.uniform(-2, 2), dice.uniform(-2, 2), dice.uniform(-0.03, 0.03)};
      judge(a, drive_through(block, later, dice), {}, same);
      const std::map<int, Change> truth = change_block(block, DayChanges{}, dice);
      judge(a, drive_through(block, later, dice), truth, changed);
    }
    int false_of_same = 0;
    for (const Score& score : same.of_kind) false_of_same += score.wrong;
    for (std::size_t k = 0; k < kKinds.size(); ++k) {
      const Score& s = changed.of_kind[k];
      print_json({{"kind", change_text(kKinds[k])},
                  {"width_sd_m", width_sd_m},
                  {"true", s.num_true},
                  {"right", s.right},
                  {"wrong", s.wrong},
                  {"unaligned", changed.num_unaligned + same.num_unaligned},
                  {"false_of_same", false_of_same},
                  {"compared_of_same", same.num_compared}});
    }
  }
}

// ids

struct Kept {
  int num_pairs = 0;    ///< trees that stand in both maps where they stood
  int num_ids = 0;      ///< of them with another id
  int num_numbers = 0;  ///< with another row or position
  int num_reused = 0;   ///< new trees with an id that was another's
  int num_twice = 0;    ///< numbers that two trees have
  int num_unaligned = 0;
};

struct Known {
  std::int32_t id = 0;
  std::pair<std::int32_t, std::int32_t> number;
};

Kept map_again(std::uint64_t seed) {
  Kept kept;
  Dice dice(seed);
  Block block = plant_block(dice, 10, 30);
  DrivenMap a = drive_through(block, Drive{}, dice);
  std::vector<Row> rows = find_rows(a.landmarks, RowsConfig{});
  number_landmarks(rows, a.landmarks);
  std::map<int, Known> known;
  std::set<std::int32_t> ids;
  for (std::size_t i = 0; i < a.landmarks.size(); ++i) {
    const Landmark& l = a.landmarks[i];
    known[a.tree_of[i]] = {l.id, {l.row, l.position}};
    ids.insert(l.id);
  }
  const std::map<int, Change> truth = change_block(block, DayChanges{}, dice);
  Drive later;
  later.T_map_block = {dice.uniform(-2, 2), dice.uniform(-2, 2), dice.uniform(-0.05, 0.05)};
  DrivenMap b = drive_through(block, later, dice);
  const MapAlignment alignment =
      align_maps(a.landmarks, b.landmarks, view_of(a), view_of(b), MapAlignmentConfig{});
  if (alignment.status != AlignmentStatus::kAligned) {
    ++kept.num_unaligned;
    return kept;
  }
  std::map<std::pair<double, double>, int> tree_at;  // keep_ids() sorts
  for (std::size_t i = 0; i < b.landmarks.size(); ++i) {
    tree_at[{b.landmarks[i].x_m, b.landmarks[i].y_m}] = b.tree_of[i];
  }
  std::int32_t next_id = 1000;
  IdTransfer numbers = keep_ids(a.landmarks, alignment, next_id, b.landmarks);
  rows = find_rows(b.landmarks, RowsConfig{});
  keep_numbers(a.landmarks, rows, b.landmarks, numbers);
  std::set<std::pair<std::int32_t, std::int32_t>> given;
  for (const Landmark& l : b.landmarks) {
    const int tree = tree_at.at({l.x_m, l.y_m});
    if (l.position != 0) kept.num_twice += !given.insert({l.row, l.position}).second;
    const auto before = known.find(tree);
    const auto change = truth.find(tree);
    const bool is_moved = change != truth.end() && change->second == Change::kMoved;
    if (before == known.end()) {
      kept.num_reused += ids.count(l.id) != 0;
      continue;
    }
    if (is_moved) {  // its own id or one of its own, nobody else's
      kept.num_reused += l.id != before->second.id && ids.count(l.id) != 0;
      continue;
    }
    ++kept.num_pairs;
    kept.num_ids += l.id != before->second.id;
    kept.num_numbers += std::make_pair(l.row, l.position) != before->second.number;
  }
  return kept;
}

void run_ids(std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const Kept kept = map_again(seed);
    print_json({{"seed", seed},
                {"pairs", kept.num_pairs},
                {"ids", kept.num_ids},
                {"numbers", kept.num_numbers},
                {"reused", kept.num_reused},
                {"twice", kept.num_twice},
                {"unaligned", kept.num_unaligned}});
  }
}

// merge

using Eigen::Vector2d;

constexpr double kHalfTurn_rad = 3.14159265358979323846;
constexpr double kWrong_m = 0.5;  ///< an alignment that puts a tree farther off is wrong

/// How the block was planted, and which aisles each robot drove.
struct Case {
  const char* name;
  double planting_sd_m, width_sd_m, missing;
  int last_of_first, first_of_second, last_of_second, first_of_third;
  bool any_place = true;  ///< else all frames agree within a metre and a degree
};

constexpr Case kCases[] = {
    {"three robots, two rows in common", 0.05, 0.02, 0.08, 4, 3, 7, 6},
    {"three robots, one aisle in common", 0.05, 0.02, 0.08, 3, 3, 7, 7},
    {"planted to a centimetre, widths 5 mm", 0.01, 0.005, 0.08, 4, 3, 7, 6},
    {"like a chessboard, none missing", 0.0, 0.0, 0.0, 4, 3, 7, 6},
    {"one frame, one aisle in common", 0.05, 0.02, 0.08, 3, 3, 7, 7, false},
    {"one frame, planted to a centimetre", 0.01, 0.005, 0.08, 3, 3, 7, 7, false},
    {"nothing in common", 0.05, 0.02, 0.08, 2, 5, 6, 9},
    {"nothing in common, planted to a centimetre", 0.01, 0.005, 0.08, 2, 5, 6, 9},
    {"nothing in common, like a chessboard", 0.0, 0.0, 0.0, 2, 5, 6, 9},
    {"one frame, nothing in common", 0.05, 0.02, 0.08, 2, 5, 6, 9, false},
    {"one frame, nothing in common, like a chessboard", 0.0, 0.0, 0.0, 2, 5, 6, 9, false},
};

struct MergeScore {
  int num_merged = 0, num_refused = 0, num_wrong = 0;
  int num_trees = 0, num_twice = 0, num_lost = 0, num_ids_lost = 0;
  double sum_m2 = 0.0;
};

/// Robots see the block from the side of their own frame.
DrivenMap drive_of(Block& block, int robot, const Case& c, Dice& dice) {
  Drive drive;
  if (robot == 0) {
    drive.last_aisle = c.last_of_first;
  } else if (robot == 1) {
    drive.first_aisle = c.first_of_second;
    drive.last_aisle = c.last_of_second;
    drive.T_map_block = {dice.uniform(-50, 50), dice.uniform(-50, 50), kHalfTurn_rad};
  } else {  // by wheels and trunks alone: bent more
    drive.first_aisle = c.first_of_third;
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

void judge_merged(const Block& block, const MergedMap& merged,
                  const std::map<std::int32_t, int>& tree_of, const DrivenMap& first,
                  const std::set<int>& mapped, MergeScore& score) {
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
  }
  score.sum_m2 += sum_m2;
}

void run_case(const Case& c, std::uint64_t seed, MergeScore& score) {
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
      return;
    }
    if (error_m(alignment, whole, b) > kWrong_m) {
      ++score.num_wrong;
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
  judge_merged(block, merged, tree_of, maps[0], mapped, score);
}

void run_merge(std::uint64_t first, std::uint64_t last) {
  for (const Case& c : kCases) {
    MergeScore score;
    for (std::uint64_t seed = first; seed <= last; ++seed) run_case(c, seed, score);
    print_json({{"case", c.name},
                {"merged", score.num_merged},
                {"refused", score.num_refused},
                {"wrong", score.num_wrong},
                {"trees", score.num_trees},
                {"twice", score.num_twice},
                {"lost", score.num_lost},
                {"ids_lost", score.num_ids_lost},
                {"rms_m", std::sqrt(score.sum_m2 / std::max(1, score.num_merged))}});
  }
}

}  // namespace
}  // namespace orchard::trials

int main(int argc, char** argv) {
  using namespace orchard::trials;
  const std::string mode = argc == 4 ? argv[1] : "";
  const auto run = mode == "changes" ? run_changes
                   : mode == "ids"   ? run_ids
                   : mode == "merge" ? run_merge
                                     : nullptr;
  if (run == nullptr) {
    std::fprintf(stderr, "usage: two_map_trials changes|ids|merge FIRST LAST\n");
    return 2;
  }
  run(std::strtoull(argv[2], nullptr, 10), std::strtoull(argv[3], nullptr, 10));
  return 0;
}
