// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "unit/vision/test_pictures.hpp"
#include "vision/edges.hpp"

namespace orchard::vision {
namespace {

/// Noise, smoothed so that edges of every direction and strength are among it.
cv::Mat texture(int width_px, int height_px, double blur_px, cv::RNG& random) {
  cv::Mat grey(height_px, width_px, CV_8UC1);
  random.fill(grey, cv::RNG::UNIFORM, 0, 256);
  if (blur_px > 0.0) cv::GaussianBlur(grey, grey, {0, 0}, blur_px);
  cv::normalize(grey, grey, 0, 255, cv::NORM_MINMAX);
  return grey;
}

void expect_opencvs_edges(const cv::Mat& grey, double low, double high) {
  cv::Mat expected;
  cv::Canny(grey, expected, low, high);
  const std::vector<std::uint8_t> edges = canny(grey.data, grey.cols, grey.rows, low, high);
  ASSERT_EQ(edges.size(), expected.total());
  EXPECT_TRUE(std::equal(edges.begin(), edges.end(), expected.data))
      << grey.cols << " x " << grey.rows << ", thresholds " << low << " and " << high;
}

TEST(Canny, EqualsOpenCvOnTextureOfEverySize) {
  cv::RNG random(5);
  for (int i = 0; i < 400; ++i) {
    const cv::Mat grey =
        texture(random.uniform(1, 70), random.uniform(1, 50), 0.7 * random.uniform(0, 5), random);
    const double low = random.uniform(1.0, 200.0);
    expect_opencvs_edges(grey, low, low + random.uniform(0.0, 300.0));
  }
}

TEST(Canny, EqualsOpenCvOnAWholePicture) {
  cv::RNG random(6);
  const cv::Mat grey = texture(640, 480, 2.0, random);
  for (const double low : {1.0, 15.5, 40.0, 1000.0}) {
    expect_opencvs_edges(grey, low, 2.5 * low);
  }
}

TEST(Canny, TheStrongestGradientsDoNotOverflow) {
  cv::RNG random(7);
  cv::Mat black_and_white = texture(61, 47, 1.0, random) > 127;
  expect_opencvs_edges(black_and_white, 1.0, 2.0);
  expect_opencvs_edges(black_and_white, 900.0, 1100.0);
  expect_opencvs_edges(black_and_white, 2000.0, 5000.0);
}

TEST(Canny, NoPictureHasNoEdges) { EXPECT_TRUE(canny(nullptr, 0, 0, 10.0, 20.0).empty()); }

constexpr double kDeg = 3.14159265358979323846 / 180.0;

/// Bright right of a line through (x_px, row 30) with a tilt, dark left of it.
cv::Mat half_planes(double x_px, double tilt_deg) {
  cv::Mat picture(60, 80, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const bool bright = x >= x_px + std::tan(tilt_deg * kDeg) * (y - 30);
      picture.at<cv::Vec3b>(y, x) = bright ? cv::Vec3b(60, 120, 180) : cv::Vec3b(30, 40, 50);
    }
  }
  return picture;
}

EdgeLine observe(const cv::Mat& picture, const PixelRect& window, double expected_x_px,
                 const EdgeConfig& config = {}) {
  return find_edge(edge_map(test::block_of(picture), config), window, expected_x_px, config);
}

constexpr PixelRect kWindow{30, 10, 20, 41};

TEST(Edges, AVerticalEdgeIsFoundInFull) {
  const EdgeLine edge = observe(half_planes(40, 0), kWindow, 38.0);
  ASSERT_TRUE(edge.found);
  EXPECT_NEAR(edge.x_px, 40.0, 1.0);
  EXPECT_NEAR(edge.tilt_rad, 0.0, 0.5 * kDeg);
  EXPECT_GT(edge.roc, 0.99);
}

TEST(Edges, TheTiltIsMeasured) {
  for (const double tilt_deg : {-15.0, -6.0, 4.0, 12.0}) {
    const EdgeLine edge = observe(half_planes(40, tilt_deg), kWindow, 40.0);
    ASSERT_TRUE(edge.found) << tilt_deg;
    EXPECT_NEAR(edge.tilt_rad / kDeg, tilt_deg, 1.5);
    EXPECT_GT(edge.roc, 0.9);
  }
}

TEST(Edges, TooMuchTiltIsNoTrunk) {
  EXPECT_LT(observe(half_planes(40, 40), kWindow, 40.0).roc, 0.5);
  EXPECT_LT(observe(half_planes(40, 89), kWindow, 40.0).roc, 0.2);
}

TEST(Edges, APlainWindowHasNone) {
  const cv::Mat picture(60, 80, CV_8UC3, cv::Scalar(90, 90, 90));
  const EdgeLine edge = observe(picture, kWindow, 40.0);
  EXPECT_FALSE(edge.found);
  EXPECT_EQ(edge.roc, 0.0);
}

TEST(Edges, RocFallsWithTheFractionOfRowsCovered) {
  cv::Mat picture = half_planes(40, 0);
  picture.rowRange(30, 60) = cv::Scalar(90, 90, 90);
  const EdgeLine edge = observe(picture, kWindow, 40.0);
  ASSERT_TRUE(edge.found);
  EXPECT_NEAR(edge.roc, 20.0 / 41.0, 0.08);
}

TEST(Edges, AStraightEdgeIsFoundAmongOthers) {
  cv::Mat picture = half_planes(40, 0);
  cv::line(picture, {31, 12}, {36, 25}, cv::Scalar(255, 255, 255), 1);
  const EdgeLine edge = observe(picture, kWindow, 40.0);
  ASSERT_TRUE(edge.found);
  EXPECT_NEAR(edge.x_px, 40.0, 1.0);
  EXPECT_GT(edge.roc, 0.95);
}

TEST(Edges, APartOfThePictureHasTheWholesEdges) {
  // With equal thresholds there is no hysteresis, which alone reaches farther than the border.
  const cv::Mat picture = test::busy_picture(160, 120, 21);
  EdgeConfig config;
  config.canny_low = 99.0;
  const EdgeMap whole = edge_map(test::block_of(picture), config);
  for (const PixelRect& window :
       {PixelRect{50, 40, 12, 40}, PixelRect{0, 0, 15, 30}, PixelRect{145, 80, 15, 40}}) {
    const PixelRect reading = edge_reading_area(window, {0, 0, 160, 120});
    const EdgeMap part = edge_map(test::block_of(picture, reading), config);
    int num_edges = 0, num_different = 0;
    for (int y = window.y_px; y < window.y_px + window.height_px; ++y) {
      for (int x = window.x_px; x < window.x_px + window.width_px; ++x) {
        const bool in_whole = whole.edges[static_cast<std::size_t>(y * 160 + x)] != 0;
        const bool in_part = part.edges[static_cast<std::size_t>(
                                 (y - reading.y_px) * reading.width_px + x - reading.x_px)] != 0;
        if (in_whole) ++num_edges;
        if (in_whole != in_part) ++num_different;
      }
    }
    EXPECT_GT(num_edges, 20);
    EXPECT_LE(num_different, 2);
  }
}

TEST(Edges, TheSmallestWindowsAreLookedAt) {
  for (const auto& [width_px, height_px] :
       {std::pair{1, 1}, std::pair{2, 1}, std::pair{1, 7}, std::pair{3, 3}}) {
    const cv::Mat picture = test::busy_picture(width_px, height_px, 4);
    const EdgeLine edge = observe(picture, {0, 0, width_px, height_px}, 0.0);
    EXPECT_GE(edge.roc, 0.0);
    EXPECT_LE(edge.roc, 1.0);
  }
}

TEST(Edges, RocStaysWithinItsBoundsOnAnyPicture) {
  EdgeConfig config;
  config.min_points = 2;
  config.canny_low = 5.0;
  config.canny_high = 10.0;
  for (const LineFit fit : {LineFit::kTotalMinSquares, LineFit::kRegression}) {
    config.fit = fit;
    for (unsigned seed = 0; seed < 60; ++seed) {
      const cv::Mat picture = test::busy_picture(30, 40, seed);
      const EdgeLine edge = observe(picture, {5, 5, 12, 30}, 11.0, config);
      EXPECT_GE(edge.roc, 0.0);
      EXPECT_LE(edge.roc, 1.0);
      EXPECT_LE(std::abs(edge.tilt_rad), config.max_tilt_deg * kDeg + 1e-12);
    }
  }
}

TEST(Edges, RefusesAWindowOutsideTheMap) {
  EXPECT_THROW(observe(half_planes(40, 0), {70, 0, 20, 20}, 75.0), std::invalid_argument);
}

TEST(Edges, ThePapersRegressionGivesNothingForAPerfectTrunk) {
  EdgeConfig paper;
  paper.fit = LineFit::kRegression;
  EXPECT_LT(observe(half_planes(40, 0), kWindow, 40.0, paper).roc, 0.05);
  EXPECT_GT(observe(half_planes(40, 12), kWindow, 40.0, paper).roc, 0.9);
}

TEST(Edges, ParallelFallsToZeroAtItsTolerance) {
  EdgeLine left, right;
  left.found = right.found = true;
  EXPECT_DOUBLE_EQ(parallel_confidence(left, right), 1.0);
  right.tilt_rad = 5.0 * kDeg;
  EXPECT_NEAR(parallel_confidence(left, right), 0.5, 1e-12);
  left.tilt_rad = -5.0 * kDeg;
  EXPECT_NEAR(parallel_confidence(left, right), 0.0, 1e-12);
  left = right;
  right.found = false;
  EXPECT_EQ(parallel_confidence(left, right), 0.0);
}

TEST(LineFit, TotalLeastSquaresKnowsEveryDirection) {
  for (int degrees = -80; degrees <= 80; degrees += 10) {
    std::vector<EdgePoint> points;
    for (int i = -200; i <= 200; i += 5) {
      points.push_back({static_cast<int>(std::lround(i * std::sin(degrees * kDeg))),
                        static_cast<int>(std::lround(i * std::cos(degrees * kDeg)))});
    }
    const auto line = fit_total_least_squares(points);
    ASSERT_TRUE(line.has_value());
    EXPECT_NEAR(line->tilt_rad / kDeg, degrees, 0.2);
    EXPECT_GT(line->straightness, 0.999);
  }
}

TEST(LineFit, ABlobIsNotStraight) {
  std::vector<EdgePoint> points;
  for (int x = 0; x < 10; ++x) {
    for (int y = 0; y < 10; ++y) points.push_back({x, y});
  }
  EXPECT_NEAR(fit_total_least_squares(points)->straightness, 0.0, 1e-9);
  EXPECT_FALSE(fit_total_least_squares({{3, 4}}).has_value());
  EXPECT_FALSE(fit_total_least_squares({{3, 4}, {3, 4}}).has_value());
  EXPECT_FALSE(fit_regression({{1, 4}, {3, 4}}).has_value());
}

}  // namespace
}  // namespace orchard::vision
