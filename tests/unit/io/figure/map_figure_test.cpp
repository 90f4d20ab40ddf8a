// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/map_figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "unit/io/figure/picture.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using mapping::Landmark;

constexpr Colour kTree{70, 180, 80}, kObject{225, 70, 60}, kPath{60, 110, 200}, kInk{30, 30, 30};

Landmark landmark(int id, Label label, double x_m, double y_m, double width_m) {
  Landmark l;
  l.id = id;
  l.label = label;
  l.x_m = x_m;
  l.y_m = y_m;
  l.width_m = width_m;
  return l;
}

/// Three trees, thick enough to be seen, and an object on the corners of 4 m by 3 m.
std::vector<Landmark> rectangle_of_four() {
  return {landmark(1, Label::kTree, 0.0, 0.0, 0.4), landmark(2, Label::kTree, 4.0, 0.0, 0.4),
          landmark(3, Label::kTree, 0.0, 3.0, 0.4), landmark(4, Label::kObject, 4.0, 3.0, 0.4)};
}

cv::Mat picture_of(const std::vector<Landmark>& landmarks,
                   const std::vector<pose::PoseEstimate>& path = {}) {
  return decoded(map_figure(landmarks, path, {}, {}, FigureFormat::kPng));
}

/// Nothing touches the page's edge, so nothing is cut.
void expect_whole(const cv::Mat& page) {
  for (const cv::Mat& edge :
       {page.row(0), page.row(page.rows - 1), page.col(0), page.col(page.cols - 1)}) {
    EXPECT_EQ(cv::countNonZero(pixels_of(edge.clone(), kWhite)), edge.rows * edge.cols);
  }
}

/// The longest horizontal run of ink in a row of pixels, as begin and length.
std::pair<int, int> longest_run(const cv::Mat& ink, int row) {
  std::pair<int, int> best{0, 0};
  int begin = 0;
  for (int x = 0; x <= ink.cols; ++x) {
    if (x < ink.cols && ink.at<std::uint8_t>(row, x) != 0) continue;
    if (x - begin > best.second) best = {begin, x - begin};
    begin = x + 1;
  }
  return best;
}

TEST(MapFigure, LandmarksStandTrueToScale) {
  const cv::Mat page = picture_of(rectangle_of_four());
  // Of the spots the legend's are the small ones.
  const auto trees = spots_of(page, kTree, 400);
  const auto objects = spots_of(page, kObject, 400);
  ASSERT_EQ(trees.size(), 3u);
  ASSERT_EQ(objects.size(), 1u);
  const Spot& right = trees[2];
  const Spot& origin = trees[0].y > trees[1].y ? trees[0] : trees[1];
  const Spot& top = trees[0].y > trees[1].y ? trees[1] : trees[0];
  const double px_per_m = (right.x - origin.x) / 4.0;
  EXPECT_NEAR(right.y, origin.y, 0.3) << "x is to the right";
  EXPECT_NEAR(top.x, origin.x, 0.3);
  EXPECT_NEAR(origin.y - top.y, 3.0 * px_per_m, 0.6) << "y is upward, of the same scale";
  EXPECT_NEAR(objects[0].x, right.x, 0.3);
  EXPECT_NEAR(objects[0].y, top.y, 0.3);
  EXPECT_NEAR(2.0 * std::sqrt(origin.area / M_PI), 0.4 * px_per_m - 1.0, 1.5)
      << "the true width, less the border";
  expect_whole(page);
}

TEST(MapFigure, AHedgeIsALineOfItsLengthAndWidth) {
  std::vector<Landmark> landmarks = rectangle_of_four();
  landmarks[3] = landmark(4, Label::kObject, 2.0, 1.5, 0.5);
  landmarks[3].length_m = 3.0;
  const cv::Mat page = picture_of(landmarks);
  const auto trees = spots_of(page, kTree, 400);
  const auto objects = spots_of(page, kObject, 400);
  ASSERT_EQ(trees.size(), 3u);
  ASSERT_EQ(objects.size(), 1u);
  const double px_per_m = (trees[2].x - std::min(trees[0].x, trees[1].x)) / 4.0;
  EXPECT_NEAR(objects[0].box.width, 3.0 * px_per_m, 3.0);
  EXPECT_NEAR(objects[0].box.height, 0.5 * px_per_m, 3.0);
}

TEST(MapFigure, TheScaleBarIsARoundNumberOfMetres) {
  const cv::Mat page = picture_of(rectangle_of_four());
  const auto trees = spots_of(page, kTree, 400);
  ASSERT_EQ(trees.size(), 3u);
  const double px_per_m = (trees[2].x - std::min(trees[0].x, trees[1].x)) / 4.0;
  const cv::Mat ink = pixels_of(page, kInk);
  int frame_row = 0;  // the plot's lower edge is the last long line
  for (int row = 0; row < page.rows; ++row) {
    if (longest_run(ink, row).second > page.cols / 2) frame_row = row;
  }
  int bar_px = 0;
  for (int row = frame_row + 1; row < page.rows; ++row) {
    bar_px = std::max(bar_px, longest_run(ink, row).second);
  }
  EXPECT_NEAR(bar_px / px_per_m, 0.5, 0.02);
}

TEST(MapFigure, TheNumberStandsBesideItsTree) {
  const cv::Mat page = picture_of(rectangle_of_four());
  for (const Spot& tree : spots_of(page, kTree, 400)) {
    const cv::Rect beside(tree.box.x + tree.box.width + 3, tree.box.y, 15, tree.box.height);
    cv::Mat dark;
    cv::inRange(page(beside), cv::Scalar(0, 0, 0), cv::Scalar(90, 160, 90), dark);
    EXPECT_GT(cv::countNonZero(dark), 5);
  }
}

TEST(MapFigure, ThePathGoesWhereTheRobotWent) {
  std::vector<pose::PoseEstimate> path(2);
  path[0].x_m = 0.0, path[0].y_m = 1.5;
  path[1].x_m = 4.0, path[1].y_m = 1.5;
  const cv::Mat page = picture_of(rectangle_of_four(), path);
  const auto trees = spots_of(page, kTree, 400);
  ASSERT_EQ(trees.size(), 3u);
  const int middle = static_cast<int>(0.5 * (trees[0].y + trees[1].y));
  const int x = static_cast<int>(0.5 * (trees[0].x + trees[2].x));
  EXPECT_GT(cv::countNonZero(pixels_of(page(cv::Rect(x - 20, middle - 2, 40, 5)), kPath)), 20);
}

TEST(MapFigure, ANarrowMapHasItsWholeLegendOnThePage) {
  std::vector<Landmark> row;
  for (int i = 0; i < 40; ++i) {
    row.push_back(landmark(i + 1,
                           i % 9 == 4   ? Label::kUnseen
                           : i % 5 == 3 ? Label::kObject
                                        : Label::kTree,
                           0.001 * i, 2.0 * i, 0.1));
  }
  mapping::NavigationGraph ways;
  ways.edges.resize(1);
  ways.edges[0].line_map = {{-1.0, 0.0}, {-1.0, 80.0}};
  mapping::Row line;
  line.number = 1;
  line.places.resize(2);
  line.places[1].p_map = {0.0, 78.0};
  const cv::Mat page = decoded(map_figure(row, {}, {line}, ways, FigureFormat::kPng));
  EXPECT_LT(page.cols, 500);
  expect_whole(page);
  // The signs of the legend stand in the strip above the plot, each with its name behind it.
  const cv::Mat ink = pixels_of(page, kInk);
  int top = 0;
  while (top < page.rows && longest_run(ink, top).second < 150) ++top;
  const cv::Mat legend = page.rowRange(0, top);
  for (const Colour sign : {kTree, kObject, Colour{205, 205, 205}, kPath, Colour{225, 190, 120}}) {
    EXPECT_FALSE(spots_of(legend, sign, 10).empty()) << int{sign.r};
  }
}

TEST(MapFigure, OfManyLandmarksRoundNumbersStayAndAllFormatsAreWritten) {
  std::vector<Landmark> crowd;
  for (int i = 0; i < 5000; ++i) {
    crowd.push_back(landmark(i + 1, Label::kTree, 0.5 * (i % 100), 2.0 * (i / 100), 0.1));
  }
  const std::string svg = map_figure(crowd, {}, {}, {}, FigureFormat::kSvg);
  EXPECT_LT(svg.size(), 10'000'000u);
  const cv::Mat page = picture_of(crowd);
  expect_whole(page);
  EXPECT_EQ(map_figure(crowd, {}, {}, {}, FigureFormat::kPdf).substr(0, 4), "%PDF");
}

TEST(MapFigure, NorthPointsAsTheMapLiesAndOnlyWhereItIsKnown) {
  // What stands in the page's upper right corner, where there is no title and no day.
  const auto arrow_box = [](std::optional<double> north_rad) {
    MapHeading heading;
    heading.north_rad = north_rad;
    const cv::Mat page =
        decoded(map_figure(rectangle_of_four(), {}, {}, {}, FigureFormat::kPng, heading));
    expect_whole(page);
    cv::Mat ink;
    const int height = north_rad ? 60 : 44;  // the plot begins below
    cv::inRange(page(cv::Rect(page.cols - 56, 0, 56, height)), cv::Scalar(0, 0, 0),
                cv::Scalar(120, 120, 120), ink);
    return cv::boundingRect(ink);
  };
  EXPECT_TRUE(arrow_box(std::nullopt).empty());
  const cv::Rect up = arrow_box(0.5 * M_PI), right = arrow_box(0.0), left = arrow_box(M_PI);
  EXPECT_GT(up.height, 1.5 * up.width);
  EXPECT_GT(right.width, 1.5 * right.height);
  EXPECT_GT(right.x + right.width, left.x + left.width + 5) << "the letter stands at the tip";
}

TEST(MapFigure, TitleAndDayStandAboveTheLegendHoweverLongTheyAre) {
  MapHeading heading;
  heading.title = std::string(300, 'W') + "\xC3\xB1 <&>";
  heading.day = "2013-06-05";
  for (const auto format : {FigureFormat::kPng, FigureFormat::kPdf, FigureFormat::kSvg}) {
    const std::string file = map_figure(rectangle_of_four(), {}, {}, {}, format, heading);
    EXPECT_EQ(file, map_figure(rectangle_of_four(), {}, {}, {}, format, heading));
    if (format == FigureFormat::kPng) expect_whole(decoded(file));
    EXPECT_EQ(file.find("20130605000000Z") != file.npos, format == FigureFormat::kPdf);
  }
  EXPECT_GT(decoded(map_figure(rectangle_of_four(), {}, {}, {}, FigureFormat::kPng, heading)).rows,
            picture_of(rectangle_of_four()).rows + 20);
}

TEST(MapFigure, AnEmptyMapAndOneOfNothingFiniteAreDrawn) {
  expect_whole(picture_of({}));
  auto landmarks = rectangle_of_four();
  landmarks[0].x_m = std::nan("");
  landmarks[1].y_m = INFINITY;
  const cv::Mat page = picture_of(landmarks);
  expect_whole(page);
  EXPECT_EQ(spots_of(page, kTree, 400).size(), 1u);
}

}  // namespace
}  // namespace orchard::io
