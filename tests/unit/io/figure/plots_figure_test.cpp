// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/plots_figure.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "io/figure/report_page.hpp"
#include "unit/io/figure/picture.hpp"

namespace orchard::io {
namespace {

using evaluation::Plot;
using ::testing::HasSubstr;

constexpr Colour kFirst{27, 120, 55};

Plot plot_with(std::vector<std::array<double, 2>> points) {
  return {"Title", "x", "y", 2.0, 6.0, 10.0, 20.0, {{"", std::move(points), false, true, false}}};
}

TEST(PlotsFigure, MarksStandWhereTheirValuesSay) {
  const cv::Mat page = decoded(
      plots_figure({plot_with({{2.0, 10.0}, {6.0, 20.0}, {3.0, 17.5}})}, FigureFormat::kPng));
  const auto marks = spots_of(page, kFirst, 10);
  ASSERT_EQ(marks.size(), 3u);
  const double width = marks[2].x - marks[0].x, height = marks[0].y - marks[2].y;
  EXPECT_GT(width, 300.0);
  EXPECT_GT(height, 200.0);
  EXPECT_NEAR(marks[1].x, marks[0].x + 0.25 * width, 0.5);
  EXPECT_NEAR(marks[1].y, marks[0].y - 0.75 * height, 0.5);
}

TEST(PlotsFigure, WhatIsOutsideStandsOnTheBorderAndWhatIsNotFiniteNowhere) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto drawn = [](std::vector<std::array<double, 2>> points) {
    return plots_figure({plot_with(std::move(points))}, FigureFormat::kPng);
  };
  EXPECT_TRUE(drawn({{9.0, 15.0}}) == drawn({{6.0, 15.0}}));
  EXPECT_TRUE(drawn({{nan, 15.0}, {3.0, 15.0}}) == drawn({{3.0, 15.0}}));
}

TEST(PlotsFigure, EachPlotHasAPlaceOfItsOwn) {
  const Plot plot = plot_with({{4.0, 15.0}});
  const cv::Mat page = decoded(plots_figure({plot, plot, plot}, FigureFormat::kPng));
  const auto marks = spots_of(page, kFirst, 10);
  ASSERT_EQ(marks.size(), 3u);
  EXPECT_NEAR(marks[0].x, marks[1].x, 0.1);
  EXPECT_NEAR(marks[2].x - marks[0].x, page.cols / 2, 0.1);
  EXPECT_NEAR(std::abs(marks[0].y - marks[1].y), page.rows / 2, 0.1);
}

TEST(ReportPage, NeedsNoOtherFileAndEscapesText) {
  const std::string page = report_page("a<b & c", {plot_with({{4.0, 15.0}})}, "1 < 2\n");
  EXPECT_THAT(page, HasSubstr("<h1>a&lt;b &amp; c</h1>"));
  EXPECT_THAT(page, HasSubstr("<pre>1 &lt; 2\n</pre>"));
  EXPECT_THAT(page, HasSubstr("<svg "));
  EXPECT_EQ(page.find("<?xml"), std::string::npos) << "no document in a document";
  for (auto at = page.find("http://"); at != std::string::npos; at = page.find("http://", at + 1)) {
    EXPECT_EQ(page.compare(at, 18, "http://www.w3.org/"), 0) << "names of SVG alone";
  }
}

}  // namespace
}  // namespace orchard::io
