// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/point_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace orchard::geometry {
namespace {

struct Point {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// Random points about the origin, a third of their coordinates exactly on a border of a cell.
class RandomPoints {
 public:
  RandomPoints(std::uint64_t seed, double cell_m) : bits_(seed), cell_m_(cell_m) {}

  std::uint64_t below(std::uint64_t n) { return bits_() % n; }
  double coordinate_m() {
    const double any_m = 60.0 * (static_cast<double>(bits_() >> 11) * 0x1p-53 - 0.5);
    return below(3) == 0 ? cell_m_ * std::round(any_m / cell_m_) : any_m;
  }
  Point point() {
    const double x_m = coordinate_m();
    return {x_m, coordinate_m()};
  }

 private:
  std::mt19937_64 bits_;
  double cell_m_;
};

std::vector<std::int32_t> visited(const PointGrid& grid, const Point& at, double radius_m) {
  std::vector<std::int32_t> all;
  grid.near(at.x_m, at.y_m, radius_m, [&](std::int32_t i) { all.push_back(i); });
  std::sort(all.begin(), all.end());
  return all;
}

/// Everything in the disc is visited once, and nothing that lies a whole cell outside of it.
void expect_as_brute_force(const PointGrid& grid, const std::map<std::int32_t, Point>& truth,
                           const Point& at, double radius_m, double cell_m) {
  const auto all = visited(grid, at, radius_m);
  ASSERT_TRUE(std::adjacent_find(all.begin(), all.end()) == all.end());
  for (const auto& [index, p] : truth) {
    if (std::hypot(p.x_m - at.x_m, p.y_m - at.y_m) > radius_m) continue;
    ASSERT_TRUE(std::binary_search(all.begin(), all.end(), index))
        << "(" << p.x_m << ", " << p.y_m << ") from (" << at.x_m << ", " << at.y_m << ")";
  }
  const double farthest_m = radius_m + cell_m;
  for (const std::int32_t index : all) {
    const auto found = truth.find(index);
    ASSERT_TRUE(found != truth.end()) << index << " was removed";
    ASSERT_LE(std::abs(found->second.x_m - at.x_m), farthest_m);
    ASSERT_LE(std::abs(found->second.y_m - at.y_m), farthest_m);
  }
}

class PointGridOfCells : public testing::TestWithParam<double> {};

TEST_P(PointGridOfCells, AnswersAsBruteForceThroughRandomOperations) {
  RandomPoints random(11, GetParam());
  PointGrid grid(GetParam());
  std::map<std::int32_t, Point> truth;
  std::int32_t next_index = 0;
  const auto any = [&] {
    auto at = truth.begin();
    std::advance(at, static_cast<long>(random.below(truth.size())));
    return at;
  };
  for (int operation = 0; operation < 40000; ++operation) {
    const std::uint64_t kind = random.below(4);
    if (truth.empty() || (kind == 0 && truth.size() < 300)) {
      const Point p = random.point();
      grid.insert(next_index, p.x_m, p.y_m);
      truth[next_index++] = p;
    } else if (kind == 1) {
      const auto gone = any();
      grid.remove(gone->first, gone->second.x_m, gone->second.y_m);
      truth.erase(gone);
    } else {
      const auto moved = any();
      const Point from = moved->second;
      // most moves of a landmark are a few millimetres
      const Point to = kind == 2 ? random.point() : Point{from.x_m + 0.004, from.y_m - 0.004};
      grid.move(moved->first, from.x_m, from.y_m, to.x_m, to.y_m);
      moved->second = to;
    }
    if (operation % 10 != 0) continue;
    expect_as_brute_force(grid, truth, random.point(), operation % 20 == 0 ? 0.3 : 3.7, GetParam());
    if (operation % 200 == 0) {  // also where there are more cells than points
      const Point at = random.point();
      const auto all = grid.near(Eigen::Vector2d(at.x_m, at.y_m), 50.0);
      ASSERT_EQ(all, visited(grid, at, 50.0));
    }
    if (HasFatalFailure()) FAIL() << "after operation " << operation;
  }
  const std::vector<std::int32_t> all = grid.near(Eigen::Vector2d(0.0, 0.0), 40.0);
  EXPECT_EQ(all.size(), truth.size());
  EXPECT_TRUE(std::is_sorted(all.begin(), all.end()));
  grid.clear();
  EXPECT_TRUE(grid.near(Eigen::Vector2d(0.0, 0.0), 40.0).empty());
}

INSTANTIATE_TEST_SUITE_P(Cells, PointGridOfCells, testing::Values(0.7, 1.0, 2.0, 4.0, 8.0));

TEST(PointGrid, ACellGivesBackTheLatestFirst) {
  PointGrid grid;
  std::vector<std::int32_t> order;
  for (const std::int32_t i : {4, 1, 3}) grid.insert(i, 0.5, 0.5);
  grid.near(0.5, 0.5, 0.1, [&](std::int32_t i) { order.push_back(i); });
  EXPECT_EQ(order, (std::vector<std::int32_t>{3, 1, 4}));
}

TEST(PointGrid, SeesAcrossTheBordersOfCells) {
  PointGrid grid;
  EXPECT_TRUE(visited(grid, {0.0, 0.0}, 10.0).empty());
  std::int32_t index = 0;
  std::map<std::int32_t, Point> truth;
  for (const double x_m : {-2.0, -1e-12, 0.0, 1e-12, 2.0}) {
    for (const double y_m : {-2.0, -1e-12, 0.0, 1e-12, 2.0}) {
      grid.insert(index, x_m, y_m);
      truth[index++] = {x_m, y_m};
    }
  }
  for (const auto& entry : truth) expect_as_brute_force(grid, truth, entry.second, 0.001, 2.0);
  expect_as_brute_force(grid, truth, {0.0, 0.0}, 2.0, 2.0);
}

TEST(PointGrid, ManyCellsInAColumnAndFarAway) {
  PointGrid grid;
  for (std::int32_t i = 0; i < 20000; ++i) grid.insert(i, -1e6 + 0.5, 2.0 * i - 20000.0 + 1.0);
  for (std::int32_t i = 0; i < 20000; ++i) {
    ASSERT_EQ(visited(grid, {-1e6 + 0.5, 2.0 * i - 20000.0 + 1.0}, 0.3),
              std::vector<std::int32_t>{i});
  }
  EXPECT_TRUE(visited(grid, {1e300, -1e300}, 1.0).empty());  // no undefined cast
}

}  // namespace
}  // namespace orchard::geometry
