// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/near_raster.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "mapping/compare/alignment_hypothesis.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

double nearest_m(const std::vector<Vector2d>& points, const Vector2d& p) {
  double nearest = 1e300;
  for (const Vector2d& q : points) nearest = std::min(nearest, (q - p).norm());
  return nearest;
}

TEST(NearRaster, NeverRulesOutAPositionNearAPointAndRulesOutMostOthers) {
  std::mt19937_64 dice(7);
  // Dense, sparse (larger cells) and far from the origin, and one point alone.
  for (const auto& [num, side_m, offset_m] :
       {std::make_tuple(2000, 130.0, 0.0), std::make_tuple(40, 5000.0, -1e5),
        std::make_tuple(1, 0.0, 3.0)}) {
    std::uniform_real_distribution<double> place(offset_m, offset_m + side_m), any(-1.0, 1.0);
    std::vector<Vector2d> points;
    for (int i = 0; i < num; ++i) points.emplace_back(place(dice), place(dice));
    const double radius_m = 0.5;
    const NearRaster raster(points, radius_m);
    int num_far = 0, num_passed = 0;
    for (int i = 0; i < 5000; ++i) {
      Vector2d p(place(dice), place(dice));
      if (i % 2 == 0) {
        p = points[static_cast<std::size_t>(i) % points.size()] +
            1.2 * Vector2d(any(dice), any(dice));
      }
      const bool is_near = nearest_m(points, p) <= radius_m;
      ASSERT_TRUE(raster.may_be_near(p) || !is_near) << p.transpose();
      if (!is_near) ++num_far;
      if (!is_near && raster.may_be_near(p)) ++num_passed;
    }
    EXPECT_LT(num_passed, side_m == 130.0 ? 0.25 * num_far : 0.5 * num_far);
  }
}

TEST(NearRaster, IsEmptyWithoutPoints) {
  EXPECT_FALSE(NearRaster({}, 0.5).may_be_near({0.0, 0.0}));
}

TEST(MostPromising, AlternatesBetweenAgreementAndNumberEachHypothesisOnce) {
  std::mt19937_64 dice(3);
  std::vector<AlignmentHypothesis> hypotheses(300);
  for (AlignmentHypothesis& h : hypotheses) {
    h.num_agreeing = std::uniform_int_distribution<int>(3, 9)(dice);
    const auto sum = [&] { return 0.01 * std::uniform_int_distribution<int>(1, 20)(dice); };
    h.sum_m2 = sum();
    h.sum_width_m2 = sum();
  }
  // The same by complete sorting.
  std::vector<double> places_m2, widths_m2;
  for (const AlignmentHypothesis& h : hypotheses) {
    places_m2.push_back(h.place_m2());
    widths_m2.push_back(h.width_m2());
  }
  const auto middle = [](std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
  };
  const double place_m2 = middle(places_m2), width_m2 = middle(widths_m2);
  std::vector<std::size_t> by_agreement, by_number;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) by_agreement.push_back(i);
  by_number = by_agreement;
  std::stable_sort(by_agreement.begin(), by_agreement.end(), [&](std::size_t i, std::size_t j) {
    return agreement(hypotheses[i], place_m2, width_m2) >
           agreement(hypotheses[j], place_m2, width_m2);
  });
  std::stable_sort(by_number.begin(), by_number.end(), [&](std::size_t i, std::size_t j) {
    const AlignmentHypothesis &x = hypotheses[i], &y = hypotheses[j];
    if (x.num_agreeing != y.num_agreeing) return x.num_agreeing > y.num_agreeing;
    return x.sum_m2 < y.sum_m2;
  });
  std::vector<std::size_t> expected;
  for (std::size_t k = 0; k < hypotheses.size(); ++k) {
    for (const std::size_t i : {by_agreement[k], by_number[k]}) {
      if (std::find(expected.begin(), expected.end(), i) == expected.end()) expected.push_back(i);
    }
  }
  std::vector<std::size_t> order;
  MostPromising promising(hypotheses);
  while (const auto next = promising.next()) order.push_back(*next);
  EXPECT_EQ(order, expected);
}

}  // namespace
}  // namespace orchard::mapping
