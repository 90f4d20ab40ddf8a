// SPDX-License-Identifier: BSD-3-Clause
// What a second visit makes of the map of a first one: whether it finds its place in it, what
// compare claims where nothing changed, and whether ids and numbers of clear trees are kept. Truth
// is how the two maps, made each for itself, lie upon each other.
#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <string>

#include "experiments/json_line.hpp"
#include "io/map/map_csv.hpp"
#include "io/map/stored_map.hpp"
#include "io/recording/recording_folder.hpp"
#include "mapping/compare/map_comparison.hpp"
#include "system/real_recordings/clear_trees.hpp"

namespace {

using namespace orchard;
using Eigen::Vector2d;
using mapping::Change;
using mapping::Landmark;

constexpr double kSame_m = 0.5;
constexpr double kConfident = 0.8;

Vector2d place_of(const Landmark& l) { return {l.x_m, l.y_m}; }

/// The map's one tree at each clear tree, by id; clear trees with none or two are left out.
std::map<std::int32_t, Landmark> clear_landmarks(const std::vector<test::ClearTree>& trees,
                                                 const std::vector<Landmark>& landmarks) {
  std::map<std::int32_t, Landmark> result;
  for (const test::ClearTree& tree : trees) {
    std::vector<const Landmark*> near;
    for (const Landmark& l : landmarks) {
      if (l.label != detection::Label::kTree) continue;
      if ((place_of(l) - Vector2d(tree.x_m, tree.y_m)).norm() < kSame_m) near.push_back(&l);
    }
    if (near.size() == 1) result[near[0]->id] = *near[0];
  }
  return result;
}

struct Visit {
  int num_claims = 0, num_confident = 0, num_at_clear = 0, num_both = 0, num_id = 0, num_number = 0,
      num_gaps = 0;
  double first_m = -1.0, travel_m = 0.0, rmse_m = 0.0, worst_m = 0.0;
};

void count_claims(const io::StoredMap& a, const mapping::MapComparison& comparison,
                  const std::map<std::int32_t, Landmark>& clear, Visit& visit) {
  for (const mapping::MapChange& c : comparison.changes) {
    if (c.change == Change::kUnchanged || c.change == Change::kNotSeen) continue;
    ++visit.num_claims;
    visit.num_confident += c.confidence >= kConfident;
    visit.num_at_clear += std::any_of(clear.begin(), clear.end(), [&](const auto& tree) {
      const Vector2d p = c.a >= 0 ? place_of(a.landmarks[static_cast<std::size_t>(c.a)]) : c.p_a;
      return (p - place_of(tree.second)).norm() < kSame_m;
    });
  }
}

void count_kept(const io::StoredMap& b, const std::vector<Landmark>& kept,
                const geometry::Pose2& T_a_b, const std::map<std::int32_t, Landmark>& clear,
                Visit& visit) {
  for (const auto& [id, tree] : clear) {
    const auto is_here = [&, p = place_of(tree)](const Landmark& l) {
      return (transform(T_a_b, place_of(l)) - p).norm() < kSame_m;
    };
    if (std::none_of(b.landmarks.begin(), b.landmarks.end(), is_here)) continue;
    ++visit.num_both;
    const auto found =
        std::find_if(kept.begin(), kept.end(), [id = id](const Landmark& l) { return l.id == id; });
    if (found == kept.end() || !is_here(*found)) continue;
    ++visit.num_id;
    const bool had_none = tree.row == 0;
    visit.num_number += had_none || (found->row == tree.row && found->position == tree.position);
  }
}

void judge_placed(const io::StoredMap& b, const std::vector<pose::PoseEstimate>& placed,
                  const geometry::Pose2& T_a_b, Visit& visit) {
  std::map<std::int64_t, Vector2d> by_time;
  for (const pose::PoseEstimate& p : placed) by_time[p.utime] = {p.x_m, p.y_m};
  double sum_m2 = 0.0;
  int num = 0;
  bool was_placed = false;
  const std::vector<pose::PoseEstimate>& path = b.trajectories.at(0);
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Vector2d p(path[k].x_m, path[k].y_m);
    if (k > 0) visit.travel_m += (p - Vector2d(path[k - 1].x_m, path[k - 1].y_m)).norm();
    const auto found = by_time.find(path[k].utime);
    visit.num_gaps += was_placed && found == by_time.end();
    was_placed = found != by_time.end();
    if (!was_placed) continue;
    if (visit.first_m < 0.0) visit.first_m = visit.travel_m;
    const double error_m = (found->second - transform(T_a_b, p)).norm();
    sum_m2 += error_m * error_m;
    visit.worst_m = std::max(visit.worst_m, error_m);
    ++num;
  }
  visit.rmse_m = num > 0 ? std::sqrt(sum_m2 / num) : -1.0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr,
                 "usage: second_visit EARLIER_RECORDING EARLIER_MAP LATER_MAP KEPT_MAP "
                 "PLACED_MAP\n");
    return 2;
  }
  try {
    const io::StoredMap a = io::read_stored_map(argv[2]), b = io::read_stored_map(argv[3]);
    const mapping::DetectionMap view_a(a.landmarks, a.trajectories, a.view);
    const mapping::DetectionMap view_b(b.landmarks, b.trajectories, b.view);
    const mapping::MapAlignment alignment =
        mapping::align_maps(a.landmarks, b.landmarks, view_a, view_b, {});
    if (alignment.status != mapping::AlignmentStatus::kAligned) {
      std::printf("compare: refused, %s\n", alignment.reason.c_str());
      return 1;
    }
    const auto trees = test::find_clear_trees(io::read_recording_folder(argv[1]));
    const auto clear = clear_landmarks(trees, a.landmarks);
    Visit visit;
    count_claims(a, mapping::compare_maps(a.landmarks, b.landmarks, view_a, view_b, alignment, {}),
                 clear, visit);
    count_kept(b, io::read_stored_map(argv[4]).landmarks, alignment.T_a_b, clear, visit);
    judge_placed(b, io::read_trajectory_csv(std::string(argv[5]) + "/trajectory.csv"),
                 alignment.T_a_b, visit);
    trials::print_json({{"claims", visit.num_claims},
                        {"confident", visit.num_confident},
                        {"at_clear", visit.num_at_clear},
                        {"in_both", visit.num_both},
                        {"with_id", visit.num_id},
                        {"with_number", visit.num_number},
                        {"placed_after_m", visit.first_m},
                        {"travel_m", visit.travel_m},
                        {"rmse_m", visit.rmse_m},
                        {"worst_m", visit.worst_m},
                        {"lost", visit.num_gaps}});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "second_visit: %s\n", error.what());
    return 3;
  }
}
