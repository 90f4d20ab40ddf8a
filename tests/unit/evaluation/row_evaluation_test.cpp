// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/row_evaluation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace orchard::evaluation {
namespace {

using Eigen::Vector2d;

/// Rows along x from 0 to 20 m, a tree a metre, at y = 0, 3, 6 ...; every second one is listed from
/// its far end.
std::vector<RowLine> rows_along_x(int num_rows) {
  std::vector<RowLine> rows(static_cast<std::size_t>(num_rows));
  for (int r = 0; r < num_rows; ++r) {
    for (int k = 0; k <= 20; ++k) {
      rows[static_cast<std::size_t>(r)].emplace_back(r % 2 == 0 ? k : 20 - k, 3.0 * r);
    }
  }
  return rows;
}

/// A pose every second, the truth at 0.5 m/s along x at y_m; the estimate off by (dx, dy).
struct Leg {
  double y_m, dx_m, dy_m;
  int num = 10;
};
std::vector<ComparedPose> drive(const std::vector<Leg>& legs) {
  std::vector<ComparedPose> compared;
  for (const Leg& leg : legs) {
    for (int i = 0; i < leg.num; ++i) {
      ComparedPose pair;
      pair.utime = 1000000 * static_cast<std::int64_t>(compared.size());
      pair.way_m = 0.5 * static_cast<double>(compared.size());
      pair.truth = {pair.utime, 5.0 + 0.5 * i, leg.y_m, 0.0};
      pair.estimate = {pair.utime, pair.truth.x_m + leg.dx_m, leg.y_m + leg.dy_m, 0.0};
      compared.push_back(pair);
    }
  }
  return compared;
}

TEST(EvaluateRows, CrossTrackErrorIsThePartAcross) {
  const RowEvaluation e =
      evaluate_rows(drive({{1.5, 3.0, 0.4, 15}, {4.5, -7.0, -0.1, 5}}), rows_along_x(4));
  EXPECT_DOUBLE_EQ(e.aisle_m, 3.0);
  EXPECT_EQ(e.num_in_aisles, 20);
  EXPECT_EQ(e.num_right_aisle, 20);
  EXPECT_NEAR(e.cross_track_m.rmse, std::sqrt((15 * 0.16 + 5 * 0.01) / 20), 1e-12);
  EXPECT_NEAR(e.cross_track_m.median, 0.4, 1e-12);
  EXPECT_NEAR(e.cross_track_95_m, 0.4, 1e-12);
  EXPECT_EQ(e.wrong_longest_s, 0.0);
}

TEST(EvaluateRows, AnotherAisleIsWrongHoweverNearTheRow) {
  // 0.1 m beside the row at y = 3: a hand's breadth further is the next aisle, the row is the same.
  const RowEvaluation e =
      evaluate_rows(drive({{2.9, 0.0, 0.05}, {2.9, 0.0, 0.2}}), rows_along_x(4));
  EXPECT_EQ(e.num_in_aisles, 20);
  EXPECT_EQ(e.num_right_aisle, 10);
  EXPECT_EQ(e.num_nearest_row, 20);
  EXPECT_NEAR(e.wrong_longest_s, 9.0, 1e-12);
  EXPECT_NEAR(e.wrong_longest_m, 4.5, 1e-12);
}

TEST(EvaluateRows, ANearestRowThatChangesInMidAisleIsNoWrongAisle) {
  const RowEvaluation e = evaluate_rows(
      drive({{1.45, 0.0, 0.1, 4}, {1.45, 0, 0, 2}, {1.45, 0, 0.1, 4}}), rows_along_x(4));
  EXPECT_EQ(e.num_right_aisle, 10);
  EXPECT_EQ(e.num_nearest_row, 2);
  EXPECT_EQ(e.num_row_switches, 2);
  EXPECT_NEAR(e.from_row_m.mean, 0.8 * 1.55 + 0.2 * 1.45, 1e-12);
  EXPECT_NEAR(e.truth_from_row_m.mean, 1.45, 1e-12);
}

TEST(EvaluateRows, TheLongestStayIsThatOfOneStay) {
  const RowEvaluation e =
      evaluate_rows(drive({{1.5, 0, 3.0, 3}, {1.5, 0, 0, 2}, {1.5, 0, -9.0, 6}, {1.5, 0, 0, 2}}),
                    rows_along_x(4));
  EXPECT_NEAR(e.wrong_longest_s, 5.0, 1e-12);
  EXPECT_NEAR(e.wrong_longest_m, 2.5, 1e-12);
}

TEST(EvaluateRows, HeadlandsAreNoAisleAndStraightBehindOneIsRight) {
  // the truth 15 m before the rows; then between them, with the estimate 12 m before them
  std::vector<ComparedPose> compared = drive({{1.5, 0, 0, 3}, {1.5, -17.0, 0.2, 4}});
  for (std::size_t i = 0; i < 3; ++i) compared[i].truth.x_m = compared[i].estimate.x_m = -15.0;
  const RowEvaluation e = evaluate_rows(compared, rows_along_x(4));
  EXPECT_EQ(e.num_compared, 7);
  EXPECT_EQ(e.num_in_aisles, 4);
  EXPECT_EQ(e.num_right_aisle, 4);
}

TEST(EvaluateRows, BesideTheLastRowIsAnAisleOfItsWidth) {
  const RowEvaluation e = evaluate_rows(drive({{10.5, 0, 1.0}, {10.5, 0, 2.0}}), rows_along_x(4));
  EXPECT_EQ(e.num_in_aisles, 20);
  EXPECT_EQ(e.num_right_aisle, 10);
  EXPECT_EQ(evaluate_rows(drive({{12.5, 0, 0}}), rows_along_x(4)).num_in_aisles, 0);
}

TEST(EvaluateRows, RowsThatEndUnevenly) {
  std::vector<RowLine> rows = rows_along_x(4);
  rows[1].erase(rows[1].begin(), rows[1].begin() + 2);  // listed from x = 20: ends at 18
  std::vector<ComparedPose> compared = drive({{1.5, 0, 0, 2}, {1.5, 0, 3.0, 2}});
  for (ComparedPose& pair : compared) pair.truth.x_m = 19.5;
  const RowEvaluation e = evaluate_rows(compared, rows);
  EXPECT_EQ(e.num_in_aisles, 4);
  EXPECT_EQ(e.num_right_aisle, 2);
}

TEST(EvaluateRows, FollowsCurvedRows) {
  // Quarter circles about the origin of 20, 23 and 26 m; the truth at 21.5 m, the estimate 0.3 m
  // farther out and ahead by an angle.
  std::vector<RowLine> rows(3);
  for (std::size_t r = 0; r < 3; ++r) {
    for (int k = 0; k <= 90; k += 2) {
      const double at_rad = k * std::acos(-1.0) / 180.0,
                   radius_m = 20.0 + 3.0 * static_cast<double>(r);
      rows[r].push_back(radius_m * Vector2d(std::cos(at_rad), std::sin(at_rad)));
    }
  }
  std::vector<ComparedPose> compared;
  for (int i = 0; i < 50; ++i) {
    ComparedPose pair;
    pair.utime = 1000000 * i;
    const double at_rad = 0.3 + 0.02 * i;
    pair.truth = {pair.utime, 21.5 * std::cos(at_rad), 21.5 * std::sin(at_rad), 0.0};
    pair.estimate = {pair.utime, 21.8 * std::cos(at_rad), 21.8 * std::sin(at_rad), 0.0};
    compared.push_back(pair);
  }
  const RowEvaluation e = evaluate_rows(compared, rows);
  EXPECT_EQ(e.num_in_aisles, 50);
  EXPECT_EQ(e.num_right_aisle, 50);
  EXPECT_NEAR(e.cross_track_m.rmse, 0.3, 0.01);  // chords of two degrees
}

TEST(EvaluateRows, RefusesWhatAreNoRows) {
  EXPECT_THROW(evaluate_rows({}, rows_along_x(1)), std::invalid_argument);
  EXPECT_THROW(evaluate_rows({}, {{{0, 0}, {1, 0}}, {{0, 3}}}), std::invalid_argument);
  EXPECT_THROW(evaluate_rows({}, {{{0, 0}, {1, 0}}, {{0, 3}, {0, 3}}}), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(evaluate_rows({}, {{{0, 0}, {1, 0}}, {{0, 3}, {nan, 3}}}), std::invalid_argument);
  EXPECT_EQ(evaluate_rows({}, rows_along_x(2)).num_compared, 0);
}

TEST(EvaluateRows, SaysWhatTheFiguresAre) {
  const RowEvaluation e = evaluate_rows(drive({{1.5, 0, 3.0}, {1.5, 0, 0, 30}}), rows_along_x(4));
  EXPECT_THAT(row_summary(e),
              testing::HasSubstr("right aisle: 75.0 % of them; longest in a wrong one: "
                                 "9.0 s, 4.5 m"));
  EXPECT_THAT(row_json(e), testing::HasSubstr("\"right_aisle\": 0.75"));
}

}  // namespace
}  // namespace orchard::evaluation
