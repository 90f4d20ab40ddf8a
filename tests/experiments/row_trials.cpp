// SPDX-License-Identifier: BSD-3-Clause
// Does finding rows depend on chance? Rows of perturbed maps (every tree displaced by its standard
// error and 3 cm, its observations Poisson-distributed) and of random blocks amid clutter.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "experiments/json_line.hpp"
#include "geometry/statistics.hpp"
#include "io/map/map_csv.hpp"
#include "mapping/rows/rows.hpp"
#include "unit/mapping/rows/planted_rows.hpp"

namespace {

using namespace orchard::mapping;
using Eigen::Vector2d;

/// A landmark of fewer observations is not in the map files (config/pullally.yaml).
constexpr int kObservationsMin = 5;
/// Displacement of trees between maps of variants of the scan matcher [m].
constexpr double kMoved_m = 0.03;
/// Standard deviation of a confidence of one observation: that of a uniform distribution.
constexpr double kRocSd = 0.29;

/// Another map that the same drive might have given: each landmark with a Poisson-distributed
/// number of observations, displaced by its standard error and by `kMoved_m`.
std::vector<Landmark> perturbed(const std::vector<Landmark>& landmarks, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Landmark> another;
  for (Landmark l : landmarks) {
    std::poisson_distribution<int> times(l.num_observations);
    const int num_observations = times(random);
    const double dx = normal(random), dy = normal(random), roc = normal(random);
    if (num_observations < kObservationsMin) continue;
    l.num_observations = num_observations;
    l.x_m += std::hypot(l.se_x_m, kMoved_m) * dx;
    l.y_m += std::hypot(l.se_y_m, kMoved_m) * dy;
    l.roc_mean = std::clamp(l.roc_mean + kRocSd / std::sqrt(num_observations) * roc, 0.01, 1.0);
    another.push_back(l);
  }
  return another;
}

std::vector<Vector2d> trees_of(const Row& row) {
  std::vector<Vector2d> trees;
  for (const RowSlot& place : row.places) {
    if (place.landmark_id != 0) trees.push_back(place.p_map);
  }
  return trees;
}

/// The sharpest turn between a row as a whole and the way from one of its trees to the next [rad].
double sharpest_turn_rad(const std::vector<Vector2d>& trees) {
  const Vector2d chord = (trees.back() - trees.front()).normalized();
  double sharpest_rad = 0.0;
  for (std::size_t i = 1; i < trees.size(); ++i) {
    const double cosine = (trees[i] - trees[i - 1]).normalized().dot(chord);
    sharpest_rad = std::max(sharpest_rad, std::acos(std::clamp(cosine, -1.0, 1.0)));
  }
  return sharpest_rad;
}

/// Median distance of a row's trees from the nearest tree of another row, across the row [m].
double distance_m(const std::vector<Vector2d>& a, const std::vector<Vector2d>& b) {
  std::vector<double> across_m;
  const Vector2d u = (a.back() - a.front()).normalized();
  for (const Vector2d& p : a) {
    const auto nearest = std::min_element(b.begin(), b.end(), [&](const auto& q, const auto& r) {
      return std::abs(u.dot(q - p)) < std::abs(u.dot(r - p));
    });
    const Vector2d d = *nearest - p;
    across_m.push_back(std::abs(u.x() * d.y() - u.y() * d.x()));
  }
  return orchard::geometry::median(std::move(across_m));
}

struct Tally {
  int num = 0, right = 0, fewer = 0, more = 0, bent = 0, apart = 0, numbered = 0;
};

void judge(const std::vector<Row>& rows, int num_rows, double pitch_m, Tally& tally) {
  ++tally.num;
  bool is_bent = false, is_apart = false;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::vector<Vector2d> trees = trees_of(rows[r]);
    tally.numbered += static_cast<int>(trees.size());
    is_bent = is_bent || sharpest_turn_rad(trees) > 0.5;
    if (r > 0) {
      const double m = distance_m(trees, trees_of(rows[r - 1]));
      is_apart = is_apart || std::abs(m - pitch_m) > 0.2 * pitch_m;
    }
  }
  const auto found = static_cast<int>(rows.size());
  tally.fewer += found < num_rows;
  tally.more += found > num_rows;
  tally.bent += is_bent;
  tally.apart += found == num_rows && is_apart;
  tally.right += found == num_rows && !is_bent && !is_apart;
}

int run_map(const std::string& path, int num_rows, double pitch_m, std::uint64_t num_seeds) {
  const std::vector<Landmark> landmarks = orchard::io::read_map_csv(path);
  Tally t;
  for (std::uint64_t seed = 1; seed <= num_seeds; ++seed) {
    judge(find_rows(perturbed(landmarks, seed), {}), num_rows, pitch_m, t);
  }
  orchard::trials::print_json({{"right", t.right},
                               {"num", t.num},
                               {"fewer", t.fewer},
                               {"more", t.more},
                               {"bent", t.bent},
                               {"apart", t.apart},
                               {"numbered", static_cast<double>(t.numbered) / t.num}});
  return 0;
}

/// Random blocks with bushes at the ends of the rows, a hedge beyond them and one beside them.
int run_planted(std::uint64_t first, std::uint64_t last) {
  int num_right = 0, num_fewer = 0, num_more = 0, num_trees = 0, num_same = 0, num_mixed = 0;
  int num_clutter = 0, num_joined = 0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    std::mt19937_64 random(seed);
    const orchard::test::Planted block = orchard::test::plant_amid_clutter(random);
    const std::vector<Row> rows = find_rows(block.landmarks, {});
    const int num_rows = block.num_rows();
    // Trees are right if their row of the map holds most of the trees planted in their row.
    bool is_mixed = false;
    int same = 0, joined = 0;
    std::map<int, int> rows_for;
    for (const Row& row : rows) {
      std::map<int, int> votes;
      for (const RowSlot& place : row.places) {
        if (place.landmark_id == 0) continue;
        const auto planted = block.numbers.find(place.landmark_id);
        if (planted == block.numbers.end()) {
          ++joined;
        } else {
          ++votes[planted->second.first];
        }
      }
      is_mixed = is_mixed || votes.size() > 1;
      const auto most = std::max_element(votes.begin(), votes.end(),
                                         [](auto& a, auto& b) { return a.second < b.second; });
      if (most == votes.end()) continue;
      ++rows_for[most->first];
      same += most->second;
    }
    const auto found = static_cast<int>(rows.size());
    num_right += found == num_rows && static_cast<int>(rows_for.size()) == num_rows && !is_mixed;
    num_fewer += found < num_rows;
    num_more += found > num_rows;
    num_mixed += is_mixed;
    num_trees += static_cast<int>(block.numbers.size());
    num_same += same;
    num_joined += joined;
    num_clutter += static_cast<int>(block.landmarks.size() - block.numbers.size());
  }
  orchard::trials::print_json({{"right", num_right},
                               {"num", last - first + 1},
                               {"fewer", num_fewer},
                               {"more", num_more},
                               {"mixed", num_mixed},
                               {"in_their_row", static_cast<double>(num_same) / num_trees},
                               {"clutter", static_cast<double>(num_joined) / num_clutter}});
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc == 6 && std::strcmp(argv[1], "map") == 0) {
      return run_map(argv[2], std::atoi(argv[3]), std::atof(argv[4]),
                     std::strtoull(argv[5], nullptr, 10));
    }
    if (argc == 4 && std::strcmp(argv[1], "planted") == 0) {
      return run_planted(std::strtoull(argv[2], nullptr, 10), std::strtoull(argv[3], nullptr, 10));
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "row_trials: %s\n", error.what());
    return 3;
  }
  std::fprintf(stderr,
               "usage: row_trials map MAP_CSV ROWS ROW_DISTANCE_M SEEDS\n"
               "       row_trials planted FIRST LAST\n");
  return 2;
}
