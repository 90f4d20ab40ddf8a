// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/figure/canvas.hpp"
#include "io/figure/map_figure.hpp"
#include "io/figure/overlay_figure.hpp"
#include "io/figure/palette.hpp"
#include "io/figure/plot_axes.hpp"
#include "io/figure/scan_figure.hpp"
#include "io/file_error.hpp"
#include "worlds/landmark.hpp"

namespace orchard::io {
namespace {

using detection::Label;
using mapping::Landmark;
using test::landmark;
using ::testing::HasSubstr;

cv::Mat decoded(const std::string& png) {
  return cv::imdecode(std::vector<std::uint8_t>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

/// Where pixels have exactly that colour: 255, elsewhere 0.
cv::Mat pixels_of(const cv::Mat& picture, Colour c) {
  cv::Mat mask;
  cv::inRange(picture, cv::Scalar(c.b, c.g, c.r), cv::Scalar(c.b, c.g, c.r), mask);
  return mask;
}

/// An area of one colour.
struct Spot {
  double x, y;  ///< its centre; the middle of the first pixel is 0.5
  double area;
  cv::Rect box;
};

/// The spots of that colour of at least so many pixels, from left to right.
std::vector<Spot> spots_of(const cv::Mat& picture, Colour colour, int num_pixels_min) {
  cv::Mat labels, stats, centres;
  const int num =
      cv::connectedComponentsWithStats(pixels_of(picture, colour), labels, stats, centres);
  std::vector<Spot> spots;
  for (int i = 1; i < num; ++i) {
    const int area = stats.at<int>(i, cv::CC_STAT_AREA);
    if (area < num_pixels_min) continue;
    spots.push_back({centres.at<double>(i, 0) + 0.5,
                     centres.at<double>(i, 1) + 0.5,
                     1.0 * area,
                     {stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                      stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT)}});
  }
  std::sort(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) { return a.x < b.x; });
  return spots;
}

constexpr Colour kRed{200, 10, 20}, kBlue{10, 20, 200}, kGreen{20, 160, 40};

cv::Vec3b bgr(Colour c) { return {c.b, c.g, c.r}; }

int count(const std::string& text, const std::string& part) {
  int num = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++num;
  return num;
}

/// One of everything.
std::string drawn(FigureFormat format) {
  Canvas canvas(format, 200, 100);
  canvas.line({10.0, 20.5}, {60.0, 20.5}, kRed, 1.0);
  canvas.circle({100.0, 50.0}, 10.0, kGreen, kBlue);
  canvas.rectangle({120.0, 40.0, 140.0, 60.0}, kRed, {});
  canvas.polygon({{150.0, 60.0}, {170.0, 60.0}, {160.0, 40.0}}, kBlue, {});
  canvas.image({10.0, 40.0, 30.0, 60.0}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 250, 251, 252}, 2, 2);
  canvas.text({10.0, 90.0}, "Row 12 <&>", {14.0, {0, 0, 0}});
  return canvas.finish();
}

TEST(Canvas, APngHasEachColourInItsPlace) {
  const cv::Mat png = decoded(drawn(FigureFormat::kPng));
  ASSERT_EQ(png.size(), cv::Size(200, 100));
  const auto at = [&png](int x, int y) { return png.at<cv::Vec3b>(y, x); };
  EXPECT_EQ(at(5, 20), bgr(kWhite));
  EXPECT_EQ(at(35, 20), bgr(kRed));
  EXPECT_EQ(at(35, 19), bgr(kWhite));
  EXPECT_EQ(at(35, 21), bgr(kWhite));
  EXPECT_EQ(at(100, 50), bgr(kGreen));
  EXPECT_EQ(at(130, 50), bgr(kRed));
  EXPECT_EQ(at(160, 55), bgr(kBlue));
  EXPECT_EQ(at(152, 42), bgr(kWhite));
  // Four pixels stretched to ten each way, not smoothed.
  EXPECT_EQ(at(10, 40), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(at(29, 40), cv::Vec3b(4, 5, 6));
  EXPECT_EQ(at(19, 59), cv::Vec3b(7, 8, 9));
  EXPECT_EQ(at(20, 50), cv::Vec3b(250, 251, 252));
}

TEST(Canvas, TextRunsAsFarAsItSaysFromItsAnchor) {
  const std::string text = "HHHHHHHH";
  const double width_px = text_width_px(text, 20.0);
  for (const TextAnchor anchor : {TextAnchor::kStart, TextAnchor::kMiddle, TextAnchor::kEnd}) {
    Canvas canvas(FigureFormat::kPng, 600, 60);
    canvas.text({300.0, 40.0}, text, {20.0, {0, 0, 0}, anchor});
    cv::Mat grey, dark;
    cv::cvtColor(decoded(canvas.finish()), grey, cv::COLOR_BGR2GRAY);
    cv::threshold(grey, dark, 128.0, 255.0, cv::THRESH_BINARY_INV);
    const cv::Rect ink = cv::boundingRect(dark);
    const double left_px = 300.0 - 0.5 * static_cast<int>(anchor) * width_px;
    // An H has a tenth of its size of air on each side.
    EXPECT_NEAR(ink.x, left_px + 2.0, 1.5);
    EXPECT_NEAR(ink.x + ink.width, left_px + width_px - 2.0, 1.5);
    EXPECT_NEAR(ink.y + ink.height, 40.0, 1.0) << "stands on the base line";
    EXPECT_NEAR(ink.height, 0.73 * 20.0, 1.0) << "capitals";
  }
  EXPECT_NEAR(text_width_px(text, 40.0), 2.0 * width_px, 1e-6);
  EXPECT_GT(text_width_px(text, 20.0, true), width_px);
}

TEST(Canvas, AnSvgHasTheShapesOfTheDrawing) {
  const std::string svg = drawn(FigureFormat::kSvg);
  EXPECT_THAT(svg, HasSubstr("width=\"200px\" height=\"100px\" viewBox=\"0 0 200 100\""));
  EXPECT_THAT(svg, HasSubstr("M 120 40 L 140 40 L 140 60 L 120 60 Z M 120 40"));
  EXPECT_THAT(svg, HasSubstr("M 10 20.5 L 60 20.5"));
  EXPECT_EQ(count(svg, "<use xlink:href=\"#glyph"), 10) << "a glyph for each letter";
  EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
}

/// The first picture within an SVG.
cv::Mat picture_in(const std::string& svg) {
  constexpr std::string_view kBegin = "data:image/png;base64,";
  const std::size_t begin = svg.find(kBegin);
  if (begin == std::string::npos) return {};
  std::string file;
  unsigned bits = 0, num_bits = 0;
  for (std::size_t i = begin + kBegin.size(); svg[i] != '"' && svg[i] != '='; ++i) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t digit = kDigits.find(svg[i]);
    if (digit == std::string_view::npos) continue;  // the end of a line
    bits = bits << 6 | static_cast<unsigned>(digit);
    if ((num_bits += 6) >= 8) file += static_cast<char>(bits >> (num_bits -= 8));
  }
  return decoded(file);
}

TEST(Canvas, MoreSignsThanFitSideBySideAreAPictureInTheirPlace) {
  const PixelBox box{20.0, 10.0, 120.0, 60.0};
  const auto svg_with = [&box](std::size_t num) {
    Canvas canvas(FigureFormat::kSvg, 200, 100);
    canvas.signs(num, 5.0, box, [&canvas] { canvas.circle({50.0, 25.0}, 5.0, kRed, kRed); });
    return canvas.finish();
  };
  EXPECT_TRUE(picture_in(svg_with(60)).empty()) << "of 64 that cover the box once";
  const cv::Mat picture = picture_in(svg_with(70));
  ASSERT_EQ(picture.size(), cv::Size(200, 100)) << "of twice the page's resolution";
  const auto spots = spots_of(picture, kRed, 10);
  ASSERT_EQ(spots.size(), 1u);
  EXPECT_NEAR(spots[0].x, 60.0, 0.5);
  EXPECT_NEAR(spots[0].y, 30.0, 0.5);
  EXPECT_NEAR(spots[0].area, 380.0, 50.0) << "a radius of 11 pixels with its rim";
}

TEST(Canvas, APdfHasOnePageOfItsSizeAndNoDateOfToday) {
  const std::string pdf = drawn(FigureFormat::kPdf);
  EXPECT_EQ(pdf.substr(0, 5), "%PDF-");
  EXPECT_EQ(count(pdf, "/Type /Page "), 1);
  EXPECT_THAT(pdf, HasSubstr("/Count 1"));
  EXPECT_THAT(pdf, HasSubstr("/MediaBox [ 0 0 150 75 ]")) << "1/72 inch";
  EXPECT_THAT(pdf, HasSubstr("DejaVuSans")) << "the letters stay letters";
  EXPECT_EQ(count(pdf, "Date"), 1);
  EXPECT_EQ(count(pdf, "(20000101000000Z)") + count(pdf, "(D:20000101000000Z)"), 1);
}

TEST(Canvas, EqualCallsGiveEqualBytes) {
  for (const auto format : {FigureFormat::kSvg, FigureFormat::kPng, FigureFormat::kPdf}) {
    const std::string first = drawn(format);
    drawn(FigureFormat::kPng);  // another surface in between
    EXPECT_TRUE(drawn(format) == first) << static_cast<int>(format);
  }
}

TEST(Canvas, WhatCannotBeDrawnIsLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto format : {FigureFormat::kSvg, FigureFormat::kPng, FigureFormat::kPdf}) {
    Canvas empty(format, 50, 40), canvas(format, 50, 40);
    canvas.line({nan, 1.0}, {5.0, infinity}, kRed, 1.0);
    canvas.circle({1e300, 1.0}, 3.0, kRed, kRed);
    canvas.circle({1.0, 1.0}, nan, kRed, kRed);
    canvas.text({nan, nan}, "x", {});
    EXPECT_TRUE(canvas.finish() == empty.finish()) << static_cast<int>(format);
  }
  Canvas canvas(FigureFormat::kPng, 50, 40);
  canvas.text({1.0, 20.0}, "\xFF\xC3 \n", {});  // no UTF-8
  EXPECT_NO_THROW(canvas.finish());
  EXPECT_THROW(canvas.image({0.0, 0.0, 1.0, 1.0}, {1, 2, 3}, 2, 2), FileError);
  EXPECT_THROW(Canvas(FigureFormat::kPng, 0, 40), FileError);
  EXPECT_THROW(Canvas(FigureFormat::kSvg, 40, 100000), FileError);
}

TEST(Canvas, TheFormatIsThatOfTheFilesName) {
  EXPECT_EQ(figure_format("a/b.svg"), FigureFormat::kSvg);
  EXPECT_EQ(figure_format("b.x.png"), FigureFormat::kPng);
  EXPECT_EQ(figure_format("b.pdf"), FigureFormat::kPdf);
  EXPECT_THROW(figure_format("b.jpg"), FileError);
  EXPECT_THROW(figure_format("png"), FileError);
}

constexpr Colour kTree{47, 125, 79}, kObject{180, 83, 47}, kObjectArea{230, 197, 185},
    kPath{59, 110, 168}, kInk{30, 30, 30};

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
  const auto objects = spots_of(page, kObjectArea, 400);
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
  const auto objects = spots_of(page, kObjectArea, 400);
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
  std::vector<Landmark> landmarks = rectangle_of_four();
  for (Landmark& l : landmarks) l.row = 1, l.position = l.id;
  const cv::Mat page = picture_of(landmarks);
  for (const Spot& tree : spots_of(page, kTree, 400)) {
    const cv::Rect beside(tree.box.x + tree.box.width + 3, tree.box.y, 15, tree.box.height);
    cv::Mat dark;
    cv::inRange(page(beside), cv::Scalar(0, 0, 0), cv::Scalar(90, 160, 90), dark);
    EXPECT_GT(cv::countNonZero(dark), 5);
  }
}

/// The colours are those of the page's light theme.
TEST(MapFigure, ItsColoursAreThePages) {
  std::ifstream file(std::string(ORCHARD_SOURCE_DIR) + "/lib/view/web/style.css");
  const std::string css((std::istreambuf_iterator<char>(file)), {});
  const auto of_page = [&css](const std::string& name) {
    const std::size_t at = css.find("--" + name + ": #");
    const int rgb = std::stoi(css.substr(at + name.size() + 5, 6), nullptr, 16);
    return std::vector<int>{rgb >> 16, rgb >> 8 & 255, rgb & 255};
  };
  const auto ours = [](Colour c) { return std::vector<int>{c.r, c.g, c.b}; };
  EXPECT_EQ(ours(kTreeColour), of_page("tree"));
  EXPECT_EQ(ours(kTrunkColour), of_page("trunk"));
  EXPECT_EQ(ours(kObjectColour), of_page("object"));
  EXPECT_EQ(ours(kUnseenColour), of_page("unseen"));
  EXPECT_EQ(ours(kPathColour), of_page("path"));
  EXPECT_EQ(ours(kRowColour), of_page("row"));
  EXPECT_EQ(ours(kGapColour), of_page("gap"));
}

/// Trunks in no row are paler than trees and in the legend by themselves; in a map without rows
/// there is nothing to tell them from.
TEST(MapFigure, TrunksInNoRowHaveAnotherShade) {
  constexpr Colour kTrunk{159, 194, 164};
  std::vector<Landmark> landmarks = rectangle_of_four();
  EXPECT_TRUE(spots_of(picture_of(landmarks), kTrunk, 10).empty());
  for (const std::size_t i : {0, 1}) landmarks[i].row = 1, landmarks[i].position = 1;
  const cv::Mat page = picture_of(landmarks);
  EXPECT_EQ(spots_of(page, kTree, 400).size(), 2u);
  EXPECT_EQ(spots_of(page, kTrunk, 400).size(), 1u);
  EXPECT_EQ(spots_of(page, kTrunk, 10).size(), 2u) << "with the legend's";
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
  for (const Colour sign : {kTree, kObject, Colour{135, 141, 147}, kPath, Colour{205, 192, 150}}) {
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

constexpr int kScale = 4;  // 320 pixels are drawn 1280 wide
const cv::Vec3b kFarBlue(255, 0, 0), kCyan(255, 255, 0);

/// A candidate between columns 100 and 120 whose left edge was found at column 103.
OverlayContent one_candidate(bool edges_judged) {
  OverlayContent content;
  content.picture.area = {0, 0, 320, 240};
  content.picture.bgr.assign(320 * 240 * 3, 40);
  OverlayCandidate c;
  c.view = {{105, 90, 10, 60}, {95, 90, 12, 60}, {114, 90, 12, 60}, 100.0, 120.0};
  c.left.found = true;
  c.left.x_px = 103.0;
  c.edges_judged = edges_judged;
  c.detection.label = detection::Label::kTree;
  content.candidates.push_back(c);
  return content;
}

cv::Mat drawn(const OverlayContent& content) {
  return decoded(overlay_figure(content, FigureFormat::kPng));
}

cv::Vec3b middle_of(const cv::Mat& sheet, int x_px, int y_px) {
  return sheet.at<cv::Vec3b>(y_px * kScale + kScale / 2, x_px * kScale + kScale / 2);
}

/// A beam straight ahead of a scanner that looks to the left: its return is to the left.
TEST(ScanFigure, AReturnStandsWhereItIsFromAbove) {
  laser::Scan scan;
  scan.bearing_step_rad = 0.1;
  scan.range_max_m = 10.0;
  scan.ranges_m = {2.0f};
  laser::LaserConfig laser;
  laser.mount_x_m = 1.0;
  laser.mount_yaw_rad = 1.5707963267948966;
  laser::SegmentationConfig segmentation;
  segmentation.range_max_m = 10.0;
  const cv::Mat picture =
      decoded(scan_figure(scan, laser, segmentation, {}, "a scan", FigureFormat::kPng));
  // Left of the legend's own sign, at the top: 900 px are 22 m.
  const cv::Mat plot = picture(cv::Rect(70, 76, 900, 900));
  std::vector<cv::Point> found;
  cv::findNonZero(pixels_of(plot, Colour{40, 70, 160}), found);
  ASSERT_FALSE(found.empty());
  const cv::Rect box = cv::boundingRect(found);
  EXPECT_NEAR(box.x + 0.5 * box.width, 450.0 - 900.0 / 22.0 * 2.0, 2.0);
  EXPECT_NEAR(box.y + 0.5 * box.height, 450.0 - 900.0 / 22.0 * 1.0, 2.0);
}

/// A trunk ahead, a wall to the left and a single beam to the right: the first is an object, the
/// others are refused, each where it stands.
TEST(ScanFigure, WhatIsRefusedIsDrawnAsSuch) {
  laser::Scan scan;
  scan.bearing_min_rad = -1.5;
  scan.bearing_step_rad = 0.01;
  scan.range_max_m = 10.0;
  scan.ranges_m.assign(301, 0.0f);
  for (std::size_t beam = 148; beam <= 152; ++beam) scan.ranges_m[beam] = 3.0f;
  for (std::size_t beam = 220; beam <= 300; ++beam) scan.ranges_m[beam] = 5.0f;
  scan.ranges_m[30] = 4.0f;
  laser::SegmentationConfig segmentation;
  segmentation.range_max_m = 10.0;
  segmentation.min_beams = 3;
  const cv::Mat picture =
      decoded(scan_figure(scan, {}, segmentation, {}, "a scan", FigureFormat::kPng));
  const cv::Mat plot = picture(cv::Rect(70, 76, 900, 900));
  const double px_per_m = 900.0 / 22.0;
  const auto is_drawn = [&](double range_m, double bearing_rad, Colour colour) {
    const double x_px = 450.0 - px_per_m * range_m * std::sin(bearing_rad);
    const double y_px = 450.0 - px_per_m * range_m * std::cos(bearing_rad);
    const cv::Rect around(static_cast<int>(x_px) - 8, static_cast<int>(y_px) - 8, 16, 16);
    return cv::countNonZero(pixels_of(plot(around).clone(), colour)) > 3;
  };
  const Colour taken{30, 140, 60}, refused{200, 120, 20};
  EXPECT_TRUE(is_drawn(3.08, 0.0, taken));
  EXPECT_FALSE(is_drawn(3.08, 0.0, refused));
  EXPECT_TRUE(is_drawn(4.02, -1.2, refused));
  EXPECT_FALSE(is_drawn(4.02, -1.2, taken));
  EXPECT_GT(cv::countNonZero(pixels_of(plot, refused)), 150) << "the wall's ring is large";
}

TEST(OverlayFigure, PointsAndEdgesStandOnTheirPixels) {
  OverlayContent content = one_candidate(true);
  content.points = {{200.0, 50.0, 6.0}};
  const cv::Mat sheet = drawn(content);
  ASSERT_EQ(sheet.cols, 320 * kScale);
  EXPECT_EQ(middle_of(sheet, 200, 50), kFarBlue);  // far
  EXPECT_EQ(middle_of(sheet, 203, 50), cv::Vec3b(40, 40, 40));
  EXPECT_EQ(middle_of(sheet, 103, 120), kCyan);
  EXPECT_EQ(middle_of(sheet, 100, 120), cv::Vec3b(40, 40, 40));
  EXPECT_EQ(middle_of(sheet, 100, 88), cv::Vec3b(255, 255, 255));  // the tick
}

TEST(OverlayFigure, EdgesThatTheDetectorDidNotLookAtShow) {
  const cv::Mat sheet = drawn(one_candidate(false));
  EXPECT_EQ(middle_of(sheet, 103, 120), cv::Vec3b(150, 150, 0));
  // The table has no number for them.
  cv::Mat difference;
  cv::absdiff(sheet.rowRange(240 * kScale, sheet.rows),
              drawn(one_candidate(true)).rowRange(240 * kScale, sheet.rows), difference);
  EXPECT_GT(cv::sum(difference)[0], 0.0);
}

}  // namespace
}  // namespace orchard::io
