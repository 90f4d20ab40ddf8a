// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/loop_closer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "simulation/random.hpp"

namespace orchard::pose {
namespace {

using geometry::rotation;

TEST(PlantedSd, IsTheIrregularityOfRows) {
  // Each of two trees that come to lie on each other stands off its place by so much.
  constexpr double kSd_m = 0.1;
  simulation::Random random(1);
  std::vector<Eigen::Vector2d> trees;
  for (int row = 0; row < 8; ++row) {
    for (int t = 0; t < 20; ++t) {
      trees.emplace_back(2.5 * t + random.normal(0.0, kSd_m),
                         4.0 * row + random.normal(0.0, kSd_m));
    }
  }
  EXPECT_NEAR(lattice_residual_sd_m(trees), std::sqrt(2.0) * kSd_m, 0.05);
}

TEST(PlantedSd, IsWhatDensityGivesWhereTreesStandInNoOrder) {
  // The nearest of points in no order is a distance r away with the density of a Gaussian of
  // variance 1 / (2 pi n) for n points a square metre (Poisson), here over two.
  simulation::Random random(2);
  std::vector<Eigen::Vector2d> trees;
  for (int i = 0; i < 400; ++i) {
    trees.emplace_back(random.uniform(0.0, 200.0), random.uniform(0.0, 200.0));
  }
  const double expected_m = std::sqrt(0.5 / (2.0 * geometry::kPi * 0.01));
  EXPECT_NEAR(lattice_residual_sd_m(trees), expected_m, 0.25 * expected_m);
}

TEST(PlantedSd, OfAFewTreesIsUnknown) {
  EXPECT_TRUE(std::isinf(lattice_residual_sd_m({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}})));
}

/// Rows that were mapped long ago, and a stretch of 20 m of two of them mapped anew, displaced by
/// what the robot drifted meanwhile.
struct Rows {
  ClosureQuery query;
  Eigen::Vector3d drift = Eigen::Vector3d(1.8, -0.9, 0.06);  ///< T_old_recent about the pivot

  Rows(std::uint64_t seed, double jitter_m, double missing, bool same_place) {
    simulation::Random random(seed);
    query.pivot = {25.0, 2.0};
    for (int row = 0; row < 3; ++row) {
      for (int t = 0; t < 24; ++t) {
        const Eigen::Vector2d p(2.5 * t + random.uniform(-jitter_m, jitter_m),
                                4.0 * row + random.uniform(-jitter_m, jitter_m));
        if (random.uniform() < missing) continue;
        query.old.push_back(landmark(100 * row + t, p));
        const bool passed = row < 2 && p.x() > 12.0 && p.x() < 32.0;
        if (passed && same_place) {
          const Eigen::Vector2d seen =
              p + Eigen::Vector2d(random.normal(0.0, 0.03), random.normal(0.0, 0.03));
          query.recent.push_back(landmark(1000 + 100 * row + t, moved_back(seen)));
        }
      }
    }
    if (!same_place) {  // two other rows that stand as regularly
      for (int row = 0; row < 2; ++row) {
        for (int t = 5; t < 13; ++t) {
          const Eigen::Vector2d p(2.5 * t + random.uniform(-jitter_m, jitter_m),
                                  4.0 * row + random.uniform(-jitter_m, jitter_m));
          if (random.uniform() < missing) continue;
          query.recent.push_back(landmark(1000 + 100 * row + t, moved_back(p)));
        }
      }
    }
    for (double x_m = 15.0; x_m <= 29.0; x_m += 0.5) {
      query.path.push_back(moved_back({x_m, 2.0}));
    }
    for (double x_m = 0.0; x_m <= 58.0; x_m += 1.0) {
      for (const double y_m : {2.0, 6.0}) query.old_path.emplace_back(x_m, y_m);
    }
    query.covariance = Eigen::Vector3d(1.5 * 1.5, 1.5 * 1.5, 0.06 * 0.06).asDiagonal();
  }

  static ClosureLandmark landmark(int id, const Eigen::Vector2d& p_map) {
    return {id, p_map, 0.12, 0.01, 5.6};
  }
  /// Where the drifted robot puts what stands there.
  Eigen::Vector2d moved_back(const Eigen::Vector2d& p) const {
    return query.pivot + rotation(drift.z()).transpose() * (p - query.pivot - drift.head<2>());
  }
};

TEST(FindClosure, LaysTheStretchWhereItBelongs) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Rows rows(seed, 0.15, 0.08, true);
    const Closure closure = find_closure(rows.query, SlamConfig{});
    ASSERT_TRUE(closure.found) << seed;
    EXPECT_LT((closure.shift - rows.drift).norm(), 0.1) << seed;
    for (const auto& [recent, old] : closure.matches) EXPECT_EQ(recent, old + 1000) << seed;
    EXPECT_GE(closure.matches.size(), rows.query.recent.size() - 1);
  }
}

TEST(FindClosure, ARegularRowWithoutGapsFitsAtEveryTreeAndIsLeftOpen) {
  const Rows rows(1, 0.0, 0.0, true);
  const Closure closure = find_closure(rows.query, SlamConfig{});
  EXPECT_FALSE(closure.found);
  EXPECT_TRUE(closure.ambiguous);
}

TEST(FindClosure, RowsNeverSeenBeforeAreNotTakenForOthers) {
  int num_found = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    num_found += find_closure(Rows(seed, 0.15, 0.08, false).query, SlamConfig{}).found;
  }
  EXPECT_EQ(num_found, 0);
}

TEST(FindClosure, WhatThePoseExcludesIsNotFound) {
  Rows rows(1, 0.15, 0.08, true);
  rows.query.covariance = Eigen::Vector3d(0.04, 0.04, 1e-4).asDiagonal();
  EXPECT_FALSE(find_closure(rows.query, SlamConfig{}).found);
}

/// 1.7 km of street between hedges, a landmark a metre on both sides, mapped again over the last
/// 45 m, with the heading unknown: half the town is within four sigma of the pose.
struct Street {
  ClosureQuery query;
  Eigen::Vector3d drift = Eigen::Vector3d(60.0, -40.0, 0.5);

  explicit Street(std::uint64_t seed, double longer = 1.0) {
    simulation::Random random(seed);
    query.pivot = {45.0, 0.0};
    const auto add = [&](std::vector<ClosureLandmark>& to, int id, const Eigen::Vector2d& p) {
      to.push_back({id, p, 0.3, 0.2, 20.0});
    };
    const double sides_m[] = {500.0, 350.0, 500.0, 350.0};
    Eigen::Vector2d corner = Eigen::Vector2d::Zero(), along(1.0, 0.0);
    int id = 0;
    for (double side_m : sides_m) {
      side_m *= longer;
      for (double s_m = 0.0; s_m < side_m; s_m += 1.0) {
        const Eigen::Vector2d aside(-along.y(), along.x());
        for (const double d_m : {-4.0, 4.0}) {
          const Eigen::Vector2d p = corner + (s_m + random.uniform(-0.5, 0.5)) * along +
                                    (d_m + random.uniform(-0.5, 0.5)) * aside;
          add(query.old, ++id, p);
          if (id > 90) continue;
          const Eigen::Vector2d seen =
              p + Eigen::Vector2d(random.normal(0.0, 0.03), random.normal(0.0, 0.03));
          add(query.recent, 10'000 + id, moved_back(seen));
        }
        query.old_path.push_back(corner + s_m * along);
      }
      corner += side_m * along;
      along = Eigen::Vector2d(-along.y(), along.x());
    }
    for (double x_m = 0.0; x_m <= 45.0; x_m += 0.5) query.path.push_back(moved_back({x_m, 0.0}));
    query.covariance = Eigen::Vector3d(214.0 * 214.0, 214.0 * 214.0, 1.3 * 1.3).asDiagonal();
  }

  Eigen::Vector2d moved_back(const Eigen::Vector2d& p) const {
    return query.pivot + rotation(drift.z()).transpose() * (p - query.pivot - drift.head<2>());
  }
};

TEST(FindClosure, HalfATownIsSearchedWithinBounds) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Street street(seed);
    const Closure closure = find_closure(street.query, SlamConfig{});
    ASSERT_TRUE(closure.found) << seed;
    EXPECT_LT((closure.shift - street.drift).norm(), 0.1) << seed;
    EXPECT_GT(closure.matches.size(), 80u) << seed;
    EXPECT_LT(closure.num_operations, 20'000'000) << seed;
  }
}

TEST(FindClosure, WhatIsBeyondTheBudgetIsLeftOpen) {
  Street city(1, 8.0);
  city.query.covariance *= 100.0;
  const Closure closure = find_closure(city.query, SlamConfig{});
  EXPECT_FALSE(closure.found);
  EXPECT_TRUE(closure.ambiguous);
  EXPECT_LT(closure.num_operations, 21'000'000);
}

TEST(FindClosure, AFewTreesAreNotEnough) {
  Rows rows(1, 0.15, 0.0, true);
  rows.query.recent.resize(4);
  EXPECT_FALSE(find_closure(rows.query, SlamConfig{}).found);
  rows.query.recent.clear();
  EXPECT_FALSE(find_closure(rows.query, SlamConfig{}).found);
}

/// Irregular trees, three of which were passed again.
ClosureQuery park(std::uint64_t seed, bool same_place) {
  simulation::Random random(seed);
  ClosureQuery query;
  query.pivot = {30.0, 30.0};
  const Eigen::Vector3d drift(1.8, -0.9, 0.06);
  const auto away = [&](const Eigen::Vector2d& p) {
    return std::none_of(query.old.begin(), query.old.end(),
                        [&](const ClosureLandmark& o) { return (o.p_map - p).norm() < 5.0; });
  };
  while (query.old.size() < 30) {
    const Eigen::Vector2d p(random.uniform(0.0, 60.0), random.uniform(0.0, 60.0));
    if (away(p)) query.old.push_back(Rows::landmark(static_cast<int>(query.old.size()), p));
  }
  const auto seen = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector2d noise(random.normal(0.0, 0.03), random.normal(0.0, 0.03));
    const Eigen::Vector2d back = p + noise - query.pivot - drift.head<2>();
    query.recent.push_back(Rows::landmark(1000 + static_cast<int>(query.recent.size()),
                                          query.pivot + rotation(drift.z()).transpose() * back));
  };
  if (same_place) {
    std::vector<ClosureLandmark> nearest = query.old;
    std::sort(nearest.begin(), nearest.end(), [&](const auto& a, const auto& b) {
      return (a.p_map - query.pivot).norm() < (b.p_map - query.pivot).norm();
    });
    for (int i = 0; i < 3; ++i) seen(nearest[static_cast<std::size_t>(i)].p_map);
  } else {
    while (query.recent.size() < 3) {
      seen({random.uniform(20.0, 40.0), random.uniform(20.0, 40.0)});
    }
  }
  query.covariance = Eigen::Vector3d(1.5 * 1.5, 1.5 * 1.5, 0.06 * 0.06).asDiagonal();
  return query;
}

TEST(FindClosure, ThreeTreesOfAParkAreEnoughWhereTheyFit) {
  int num_found = 0, num_wrong = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Closure right = find_closure(park(seed, true), SlamConfig{});
    num_found += right.found;
    if (right.found) {
      EXPECT_LT((right.shift.head<2>() - Eigen::Vector2d(1.8, -0.9)).norm(), 0.3);
    }
    num_wrong += find_closure(park(seed, false), SlamConfig{}).found;
  }
  EXPECT_GE(num_found, 90);
  EXPECT_EQ(num_wrong, 0);
}

}  // namespace
}  // namespace orchard::pose
