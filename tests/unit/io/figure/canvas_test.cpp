// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/canvas.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "io/file_error.hpp"
#include "unit/io/figure/picture.hpp"

namespace orchard::io {
namespace {

using ::testing::HasSubstr;

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

}  // namespace
}  // namespace orchard::io
