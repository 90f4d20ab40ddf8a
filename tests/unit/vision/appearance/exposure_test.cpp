// SPDX-License-Identifier: BSD-3-Clause
// Pictures of the same light at several exposures, encoded here by IEC 61966-2-1.
#include "vision/appearance/exposure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "unit/vision/test_pictures.hpp"
#include "vision/appearance/appearance.hpp"

namespace orchard::vision {
namespace {

constexpr PixelRect kWindow{40, 20, 16, 32};

std::uint8_t encoded(double light) {
  const double value =
      light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
}

/// Bark before leaves: light of 2 to 30 % of what saturates, `exposure_ev` brighter.
PixelBlock bark_at(double exposure_ev) {
  std::mt19937 random(3);
  std::uniform_real_distribution<> light(0.02, 0.30);
  cv::Mat picture(80, 96, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      const double bright = light(random) * std::exp2(exposure_ev);
      picture.at<cv::Vec3b>(y, x) = {encoded(0.6 * bright), encoded(0.9 * bright), encoded(bright)};
    }
  }
  return test::block_of(picture);
}

double mean_difference(const AppearanceFeatures& a, const AppearanceFeatures& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

TEST(Exposure, AnUnderexposedPictureHasTheContrastsOfAWellExposedOne) {
  PixelBlock bright = bark_at(0.0);
  normalise_exposure(bright);
  const auto expected = appearance_features(bright, kWindow);
  for (const double exposure_ev : {-1.0, -2.0}) {
    PixelBlock dark = bark_at(exposure_ev);
    const double before = mean_difference(appearance_features(dark, kWindow), expected);
    normalise_exposure(dark);
    const double after = mean_difference(appearance_features(dark, kWindow), expected);
    EXPECT_LT(after, 0.015) << exposure_ev;
    EXPECT_GT(before, 1.5 * after) << exposure_ev;
  }
}

TEST(Exposure, BrightAndBlackPicturesStayAsTheyAre) {
  for (const double exposure_ev : {1.0, 2.0, -8.0}) {
    PixelBlock pixels = bark_at(exposure_ev);
    const auto before = pixels.bgr;
    normalise_exposure(pixels);
    EXPECT_EQ(pixels.bgr, before) << exposure_ev;
  }
  PixelBlock empty;
  normalise_exposure(empty);
  EXPECT_TRUE(empty.bgr.empty());
}

TEST(Exposure, AModelLearnsADarkPictureAsItJudgesIt) {
  PixelBlock judged = bark_at(-2.0);
  const auto learnt = learnt_exposures(judged);
  normalise_exposure(judged);
  ASSERT_EQ(learnt.size(), kLearntExposures_ev.size());
  EXPECT_EQ(learnt[0].bgr, judged.bgr);
  for (std::size_t i = 1; i < learnt.size(); ++i) {
    EXPECT_EQ(learnt[i].bgr, exposed(judged, kLearntExposures_ev[i]).bgr) << i;
    EXPECT_NE(learnt[i].bgr, learnt[i - 1].bgr) << i;
  }
}

}  // namespace
}  // namespace orchard::vision
