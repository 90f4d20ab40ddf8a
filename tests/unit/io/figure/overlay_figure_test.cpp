// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/overlay_figure.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

namespace orchard::io {
namespace {

constexpr int kScale = 4;  // 320 pixels are drawn 1280 wide
const cv::Vec3b kBlue(255, 0, 0), kCyan(255, 255, 0);

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
  const std::string png = overlay_figure(content, FigureFormat::kPng);
  return cv::imdecode(std::vector<std::uint8_t>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

cv::Vec3b middle_of(const cv::Mat& sheet, int x_px, int y_px) {
  return sheet.at<cv::Vec3b>(y_px * kScale + kScale / 2, x_px * kScale + kScale / 2);
}

TEST(OverlayFigure, PointsAndEdgesStandOnTheirPixels) {
  OverlayContent content = one_candidate(true);
  content.points = {{200.0, 50.0, 6.0}};
  const cv::Mat sheet = drawn(content);
  ASSERT_EQ(sheet.cols, 320 * kScale);
  EXPECT_EQ(middle_of(sheet, 200, 50), kBlue);  // far
  EXPECT_EQ(middle_of(sheet, 203, 50), cv::Vec3b(40, 40, 40));
  EXPECT_EQ(middle_of(sheet, 103, 120), kCyan);
  EXPECT_EQ(middle_of(sheet, 100, 120), cv::Vec3b(40, 40, 40));
  EXPECT_EQ(middle_of(sheet, 100, 88), cv::Vec3b(255, 255, 255));  // the tick
}

TEST(OverlayFigure, EdgesThatTheDetectorDidNotObservationAtShow) {
  const cv::Mat sheet = drawn(one_candidate(false));
  EXPECT_EQ(middle_of(sheet, 103, 120), cv::Vec3b(150, 150, 0));
  // The table has no number for them.
  cv::Mat difference;
  cv::absdiff(sheet.rowRange(240 * kScale, sheet.rows),
              drawn(one_candidate(true)).rowRange(240 * kScale, sheet.rows), difference);
  EXPECT_GT(cv::sum(difference)[0], 0.0);
}

TEST(OverlayFigure, TheSameContentGivesTheSameBytes) {
  EXPECT_EQ(overlay_figure(one_candidate(true), FigureFormat::kPng),
            overlay_figure(one_candidate(true), FigureFormat::kPng));
}

}  // namespace
}  // namespace orchard::io
