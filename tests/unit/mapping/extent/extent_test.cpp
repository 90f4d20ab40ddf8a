// SPDX-License-Identifier: BSD-3-Clause
// Which landmarks are parts of a bush: what certainly is no tree where the borders touch, what
// rather is none where it overlaps the bush.
#include "mapping/extent/extent.hpp"
#include "worlds/landmark.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace orchard::mapping {
namespace {

/// A bush 0.8 m wide at the origin, and something 0.1 m wide beside or in it.
std::int32_t bush_of(double x_m, float log_odds) {
  MapperConfig config;
  LandmarkTable landmarks;
  const auto add = [&](double at_m, double width_m, float odds, bool is_clump) {
    const std::int32_t index = landmarks.add({at_m, 0.0}, width_m);
    landmarks.change(index, [&](LandmarkRecord& r) {
      r.width_m = static_cast<float>(width_m);
      r.log_odds = odds;
      r.num_observations = r.num_all = 10;
      r.is_seen = true;
      r.is_clump = is_clump;
    });
    return index;
  };
  const std::int32_t bush = add(0.0, 0.8, -8.0f, true);
  const std::int32_t part = add(x_m, 0.1, log_odds, false);
  EXPECT_EQ(touching_clump(landmarks, bush, config) == part,
            touching_clump(landmarks, part, config) == bush);
  return touching_clump(landmarks, part, config);
}

TEST(Extent, WhatIsCertainlyNoTreeIsPartOfTheBushItTouches) {
  EXPECT_EQ(bush_of(0.5, -4.0f), 0);
  EXPECT_EQ(bush_of(0.7, -4.0f), -1);
}

TEST(Extent, InABushItIsEnoughToBeRatherNone) {
  EXPECT_EQ(bush_of(0.2, -0.5f), 0);
  EXPECT_EQ(bush_of(0.43, -0.5f), 0) << "they overlap";
  EXPECT_EQ(bush_of(0.47, -0.5f), -1) << "they only touch";
  EXPECT_EQ(bush_of(0.2, 0.5f), -1);
}

/// Area of a polygon (shoelace formula), positive when it runs counter-clockwise.
double area_m2(const std::vector<Eigen::Vector2d>& border) {
  double twice_m2 = 0.0;
  for (std::size_t i = 0; i < border.size(); ++i) {
    const Eigen::Vector2d& a = border[i];
    const Eigen::Vector2d& b = border[(i + 1) % border.size()];
    twice_m2 += a.x() * b.y() - b.x() * a.y();
  }
  return 0.5 * twice_m2;
}

void expect_each_point_once(const std::vector<Eigen::Vector2d>& border) {
  for (std::size_t i = 0; i < border.size(); ++i) {
    EXPECT_GT((border[i] - border[(i + 1) % border.size()]).norm(), 1e-3) << i;
  }
}

Landmark thing_of(double width_m, double length_m) {
  Landmark l;
  l.x_m = 3.0;
  l.y_m = -2.0;
  l.width_m = width_m;
  l.length_m = length_m;
  l.direction_rad = 0.7;
  return l;
}

TEST(Outline, OfWhatIsRoundIsItsDiscAndNoPointTwice) {
  const auto border = outline_of(thing_of(1.2, 0.0));
  expect_each_point_once(border);
  const double disc_m2 = M_PI * 0.6 * 0.6;
  EXPECT_NEAR(area_m2(border), disc_m2, 0.02 * disc_m2);
}

TEST(Outline, OfAHedgeIsARectangleWithTwoHalfDiscs) {
  const auto border = outline_of(thing_of(0.8, 6.0));
  expect_each_point_once(border);
  const double area = M_PI * 0.4 * 0.4 + 5.2 * 0.8;
  EXPECT_NEAR(area_m2(border), area, 0.01 * area);
}

/// A landmark of which `num` observations scatter by `sd_m` per axis about their mean: the standard
/// error of a mean is the scatter over the root of their number.
Landmark tree(double sd_m, int num, int row) {
  Landmark l;
  l.label = detection::Label::kTree;
  l.num_observations = num;
  l.se_x_m = l.se_y_m = sd_m / std::sqrt(num);
  l.row = row;
  return l;
}

TEST(StemScatterTest, AreAsSharpAsTheTreesOfTheRows) {
  std::vector<Landmark> map;
  map.reserve(20);
  for (int i = 0; i < 20; ++i) map.push_back(tree(0.03 + 0.001 * i, 12 + 5 * i, 1 + i / 10));
  const StemScatterTest stems(map);
  EXPECT_TRUE(stems.contains(tree(0.04, 15, 0))) << "a stem in a hedge";
  EXPECT_FALSE(stems.contains(tree(0.15, 15, 0))) << "leaves, met at another depth each time";
  EXPECT_TRUE(stems.contains(tree(0.04, 400, 0))) << "however often it was seen";
  EXPECT_FALSE(stems.contains(tree(0.15, 400, 0)));
}

TEST(StemScatterTest, TooFewObservationsTellNothing) {
  const StemScatterTest stems({tree(0.03, 40, 1), tree(0.04, 40, 1)});
  EXPECT_FALSE(stems.contains(tree(0.01, 3, 0)));
}

TEST(StemScatterTest, AreTrees) {
  const StemScatterTest stems({tree(0.03, 40, 1), tree(0.04, 40, 1)});
  Landmark post = tree(0.01, 40, 0);
  post.label = detection::Label::kObject;
  EXPECT_FALSE(stems.contains(post));
}

TEST(StemScatterTest, WithoutRowsNothingIsCalledSharp) {
  const StemScatterTest stems({tree(0.03, 40, 0), tree(0.04, 40, 0)});
  EXPECT_FALSE(stems.contains(tree(0.01, 40, 0)));
}

using Eigen::Vector2d;

constexpr double kWidest_m = 2.0;

Landmark thing(int id, const Vector2d& p, double width_m = 0.3) {
  Landmark l = test::tree(id, p.x(), p.y(), width_m, 10);  // as a laser takes bits of a hedge
  l.probability = 1.0;
  return l;
}

/// Bits of a hedge every half to whole metre from one place to another.
void plant(std::vector<Landmark>& all, const Vector2d& from, const Vector2d& to,
           std::mt19937& random) {
  std::uniform_real_distribution<> step_m(0.5, 1.0), off_m(-0.25, 0.25), width_m(0.15, 0.5);
  const Vector2d along = (to - from).normalized(), across(-along.y(), along.x());
  for (double s_m = 0.0; s_m <= (to - from).norm(); s_m += step_m(random)) {
    all.push_back(thing(static_cast<int>(all.size()) + 1,
                        from + s_m * along + off_m(random) * across, width_m(random)));
  }
}

double to_segment_m(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (a + t * (b - a) - p).norm();
}

const auto kNobody = [](const Landmark&) { return false; };

/// All else is seen free.
PositionTest not_in(const PositionTest& is_blocked) {
  return [is_blocked](const Vector2d& p) { return !is_blocked(p); };
}

/// A passage is shut if its middle is blocked.
PassageTest shut_by(const PositionTest& is_blocked) {
  return [is_blocked](const Vector2d& from, const Vector2d& to, double, double) {
    return is_blocked(0.5 * (from + to)) ? Passage::kShut : Passage::kUnknown;
  };
}

TEST(LongThings, AHedgeIsOneLine) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    const Vector2d from(3.0, -7.0),
        to = from + 15.0 * Vector2d(std::cos(0.1 * seed), std::sin(0.1 * seed));
    std::vector<Landmark> all;
    plant(all, from, to, random);
    const auto in_hedge = [&](const Vector2d& p) { return to_segment_m(p, from, to) < 0.5; };
    const auto joined =
        join_long_objects(all, kWidest_m, shut_by(in_hedge), not_in(in_hedge), kNobody);
    ASSERT_EQ(joined.size(), 1u) << "seed " << seed;
    const Landmark& hedge = joined.front();
    EXPECT_EQ(hedge.id, 1);
    EXPECT_EQ(hedge.label, detection::Label::kObject);
    EXPECT_NEAR(hedge.length_m, 15.0, 1.3);
    EXPECT_NEAR(std::remainder(hedge.direction_rad - 0.1 * seed, M_PI), 0.0, 0.05);
    EXPECT_LT((Vector2d(hedge.x_m, hedge.y_m) - 0.5 * (from + to)).norm(), 0.7);
    EXPECT_GT(hedge.width_m, 0.5);
    EXPECT_LT(hedge.width_m, 1.0);
  }
}

/// What is wider than any thing that a scan reports leaves a gap, and so does a gate: beams pass
/// one.
TEST(LongThings, ALineGoesOnWhereTheHedgeDoesAndEndsAtAGate) {
  for (const bool has_gate : {false, true}) {
    std::mt19937 random(3);
    std::vector<Landmark> all;
    plant(all, {0.0, 0.0}, {8.0, 0.0}, random);
    plant(all, {13.0, 0.0}, {20.0, 0.0}, random);
    const auto in_hedge = [&](const Vector2d& p) {
      return std::abs(p.y()) < 0.4 && !(has_gate && p.x() > 9.0 && p.x() < 12.0);
    };
    const auto joined =
        join_long_objects(all, kWidest_m, shut_by(in_hedge), not_in(in_hedge), kNobody);
    EXPECT_EQ(joined.size(), has_gate ? 2u : 1u);
  }
}

/// The robot did not come near enough to the middle of a hedge: nothing was seen there, and no
/// gate.
TEST(LongThings, ALineGoesOnWhereNothingWasSeen) {
  std::mt19937 random(5);
  std::vector<Landmark> all;
  plant(all, {0.0, 0.0}, {12.0, 0.0}, random);
  plant(all, {19.0, 0.0}, {30.0, 0.0}, random);
  const auto seen = [](const Vector2d& p) { return p.x() < 13.0 || p.x() > 18.0; };
  const auto in_hedge = [&](const Vector2d& p) { return seen(p) && std::abs(p.y()) < 0.4; };
  const auto is_free = [&](const Vector2d& p) { return seen(p) && std::abs(p.y()) >= 0.4; };
  EXPECT_EQ(join_long_objects(all, kWidest_m, shut_by(in_hedge), is_free, kNobody).size(), 1u);
  // farther apart than either is long, they are two
  for (Landmark& l : all) l.x_m += l.x_m > 15.0 ? 10.0 : 0.0;
  const auto nowhere = [](const Vector2d&) { return false; };
  EXPECT_EQ(join_long_objects(all, kWidest_m, shut_by(in_hedge), nowhere, kNobody).size(), 2u);
}

/// The circle around a box reaches beyond its sides: a bush beside it seems to touch it, but beams
/// pass between them.
TEST(LongThings, WhatBeamsPassBetweenIsNotOneThoughBordersSeemToTouch) {
  const std::vector<Landmark> all{thing(1, {0.0, 0.0}, 0.6), thing(2, {1.2, 0.0}, 1.7)};
  for (const bool is_open : {false, true}) {
    const PassageTest passage = [&](const Vector2d& from, const Vector2d& to, double, double) {
      const double x_m = 0.5 * (from + to).x();
      return is_open && x_m > 0.35 && x_m < 0.55 ? Passage::kOpen : Passage::kShut;
    };
    const auto joined = join_long_objects(
        all, 2.0, passage, [](const Vector2d&) { return false; }, kNobody);
    EXPECT_EQ(joined.size(), is_open ? 2u : 1u);
  }
}

/// Beams seldom reach the far end of a hedge: nothing tells that its parts there are one. What
/// stands in the hedge's place is of it, and so is what comes next in line, unless a passage was
/// seen free; what stands beside it is not.
TEST(LongThings, WhatStandsInAHedgeIsOfItAndNothingBesideIt) {
  std::mt19937 random(7);
  std::vector<Landmark> all;
  plant(all, {0.0, 0.0}, {12.0, 0.0}, random);
  plant(all, {18.0, 0.0}, {30.0, 0.0}, random);
  const auto seen = [](const Vector2d& p) {
    return (p.x() > -0.5 && p.x() < 13.0) || p.x() > 17.5;
  };
  const auto in_hedge = [&](const Vector2d& p) { return seen(p) && std::abs(p.y()) < 0.4; };
  const auto is_free = [&](const Vector2d& p) { return seen(p) && std::abs(p.y()) >= 0.4; };
  all.push_back(thing(200, {15.0, 0.1}));   // in the unseen part
  all.push_back(thing(201, {-1.5, 0.0}));   // in line before its begin
  all.push_back(thing(202, {-3.2, 0.1}));   // and before that
  all.push_back(thing(203, {6.0, 1.2}));    // beside it
  all.push_back(thing(204, {15.0, -1.2}));  // beside the unseen part
  all.push_back(thing(205, {-6.5, 0.0}));   // too far before its begin
  const auto joined = join_long_objects(all, kWidest_m, shut_by(in_hedge), is_free, kNobody);
  ASSERT_EQ(joined.size(), 4u);
  EXPECT_NEAR(joined[0].length_m, 33.3, 1.0);
  EXPECT_LT(joined[0].width_m, 1.0);
  EXPECT_EQ(joined[1].id, 203);
  EXPECT_EQ(joined[2].id, 204);
  EXPECT_EQ(joined[3].id, 205);
  // a gate between its begin and what stands before it
  const auto is_gate = [&](const Vector2d& p) { return is_free(p) || p.x() < -0.4; };
  EXPECT_EQ(join_long_objects(all, kWidest_m, shut_by(in_hedge), is_gate, kNobody).size(), 6u);
}

TEST(LongThings, ACornerIsTwoLines) {
  std::mt19937 random(1);
  const Vector2d a(0.0, 0.0), b(20.0, 0.0), c(20.0, 12.0);
  std::vector<Landmark> all;
  plant(all, a, b, random);
  plant(all, b, c, random);
  const auto in_hedge = [&](const Vector2d& p) {
    return to_segment_m(p, a, b) < 0.5 || to_segment_m(p, b, c) < 0.5;
  };
  const auto joined =
      join_long_objects(all, kWidest_m, shut_by(in_hedge), not_in(in_hedge), kNobody);
  ASSERT_GE(joined.size(), 2u);
  int num_long = 0;
  for (const Landmark& l : joined) num_long += l.length_m > 8.0 && l.width_m < 2.1;
  EXPECT_EQ(num_long, 2);
  EXPECT_LE(joined.size(), 3u);  // a bit in the corner may be of neither
}

/// Beams pass between trunks however near they stand.
TEST(LongThings, TrunksThatBeamsPassBetweenStandAlone) {
  std::vector<Landmark> all;
  for (int i = 0; i < 20; ++i) all.push_back(thing(i + 1, {0.8 * i, 0.0}, 0.1));
  const auto nowhere = [](const Vector2d&) { return false; };
  EXPECT_EQ(join_long_objects(all, kWidest_m, shut_by(nowhere), not_in(nowhere), kNobody).size(),
            20u);
}

TEST(LongThings, WhatIsShortStaysAsItIs) {
  std::vector<Landmark> all{thing(1, {0.0, 0.0}), thing(2, {0.2, 0.0}), thing(3, {5.0, 0.0}, 1.5)};
  const auto everywhere = [](const Vector2d&) { return true; };
  EXPECT_EQ(
      join_long_objects(all, kWidest_m, shut_by(everywhere), not_in(everywhere), kNobody).size(),
      3u);
}

TEST(LongThings, ATreeOfARowStandsAloneInAHedge) {
  std::mt19937 random(2);
  std::vector<Landmark> all;
  plant(all, {0.0, 0.0}, {10.0, 0.0}, random);
  all.push_back(thing(100, {5.0, 0.1}));
  all.back().row = 1;
  const auto everywhere = [](const Vector2d&) { return true; };
  const auto joined = join_long_objects(all, kWidest_m, shut_by(everywhere), not_in(everywhere),
                                        [](const Landmark& l) { return l.row > 0; });
  ASSERT_EQ(joined.size(), 2u);
  EXPECT_EQ(joined[1].id, 100);
  EXPECT_EQ(joined[1].length_m, 0.0);
}

TEST(LongThings, DiscsAlongTheMiddleLineCoverIt) {
  Landmark l = thing(1, {2.0, 1.0}, 0.6);
  l.length_m = 9.0;
  l.direction_rad = 0.7;
  const auto places = centre_line(l);
  const Vector2d along(std::cos(0.7), std::sin(0.7)), across(-along.y(), along.x());
  for (double s_m = -4.2; s_m <= 4.2; s_m += 0.05) {
    const Vector2d border = Vector2d(2.0, 1.0) + s_m * along + 0.28 * across;
    double nearest_m = 1e9;
    for (const Vector2d& p : places) nearest_m = std::min(nearest_m, (p - border).norm());
    EXPECT_LE(nearest_m, 0.3) << s_m;
  }
}

}  // namespace

}  // namespace orchard::mapping
