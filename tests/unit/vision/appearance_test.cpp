// SPDX-License-Identifier: BSD-3-Clause
// Pictures of the same light at several exposures, encoded here by IEC 61966-2-1.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <random>
#include <stdexcept>
#include <string>

#include "unit/vision/test_pictures.hpp"
#include "vision/appearance.hpp"
#include "vision/block_view.hpp"

namespace orchard::vision {
namespace {

constexpr PixelRect kWindow{40, 20, 16, 32};  // two pixels per column of the grid

std::size_t index_of(const std::string& name) {
  for (std::size_t i = 0; i < kNumAppearanceFeatures; ++i) {
    if (name == kAppearanceFeatureNames[i]) return i;
  }
  ADD_FAILURE() << "no feature " << name;
  return 0;
}

double feature(const AppearanceFeatures& features, const std::string& name) {
  return features[index_of(name)];
}

/// A bar of one colour on another, as wide as the window.
cv::Mat bar(const cv::Scalar& bar_bgr, const cv::Scalar& rest_bgr) {
  cv::Mat picture(80, 96, CV_8UC3, rest_bgr);
  picture(cv::Rect(kWindow.x_px, 0, kWindow.width_px, picture.rows)).setTo(bar_bgr);
  return picture;
}

/// A model that listens to every feature.
AppearanceConfig some_model() {
  AppearanceConfig config;
  config.mean.assign(kNumAppearanceFeatures, 0.1);
  config.scale.assign(kNumAppearanceFeatures, 0.5);
  for (std::size_t i = 0; i < kNumAppearanceFeatures; ++i) {
    config.weights.push_back(i % 2 == 0 ? 0.2 : -0.2);
  }
  return config;
}

/// Light of another strength and colour.
cv::Mat in_light(const cv::Mat& picture, double blue, double green, double red) {
  cv::Mat result;
  cv::multiply(picture, cv::Scalar(blue, green, red), result);
  return result;
}

TEST(Appearance, OfOneColourNothingStandsOut) {
  const auto f = appearance_features(test::block_of(bar({50, 90, 120}, {50, 90, 120})), kWindow);
  for (const char* name :
       {"brightness_contrast", "red_contrast", "blue_contrast", "brightness_stands_out",
        "brightness_in_scene", "red_in_scene", "brightness_bands_differ", "brightness_in_columns",
        "brightness_step_strong", "colour_step_strong", "step_agrees_strong", "brightness_bulge",
        "brightness_slant", "rows_spread", "brights_contrast", "darks_contrast"}) {
    EXPECT_NEAR(feature(f, name), 0.0, 1e-6) << name;
  }
  EXPECT_NEAR(feature(f, "brightness_spread"), std::log(0.02), 1e-4);
  EXPECT_NEAR(feature(f, "gradient_along_beside"), std::log(0.02), 1e-4);
}

TEST(Appearance, ABarTwiceAsBrightHasItsContrast) {
  // Mean over window and bands: (60 + 120 + 60) / 3 = 80, so the bar is 1.5 of it, the rest 0.75.
  const auto f = appearance_features(test::block_of(bar({120, 120, 120}, {60, 60, 60})), kWindow);
  const double contrast = std::log(1.6) - std::log(0.85);
  EXPECT_NEAR(feature(f, "brightness_contrast"), contrast, 1e-5);
  EXPECT_NEAR(feature(f, "brightness_stands_out"), contrast, 1e-5);
  EXPECT_NEAR(feature(f, "brightness_step_weak"), contrast, 1e-5);
  EXPECT_NEAR(feature(f, "brightness_step_strong"), contrast, 1e-5);
  EXPECT_DOUBLE_EQ(feature(f, "step_agrees_weak"), 1.0);
  EXPECT_NEAR(feature(f, "brights_contrast"), contrast, 1e-5);
  EXPECT_NEAR(feature(f, "red_contrast"), 0.0, 1e-6);
  // The whole rows: 16 of 96 columns are the bar.
  const double scene = (80.0 * 60.0 + 16.0 * 120.0) / 96.0;
  EXPECT_NEAR(feature(f, "brightness_in_scene"), std::log(121.0 / (scene + 1.0)), 1e-6);
}

TEST(Appearance, RedderAndBlueThanItsSurroundings) {
  const auto red = appearance_features(test::block_of(bar({60, 60, 120}, {60, 60, 60})), kWindow);
  EXPECT_GT(feature(red, "red_contrast"), 0.5);
  EXPECT_NEAR(feature(red, "blue_contrast"), 0.0, 1e-6);
  EXPECT_GT(feature(red, "red_in_scene"), 0.5);
  const auto blue = appearance_features(test::block_of(bar({120, 60, 60}, {60, 60, 60})), kWindow);
  EXPECT_GT(feature(blue, "blue_contrast"), 0.5);
  EXPECT_GT(feature(blue, "colour_step_weak"), 0.5);
}

TEST(Appearance, OneSidedStepDoesNotStandOut) {
  cv::Mat picture(80, 96, CV_8UC3, cv::Scalar::all(60));
  picture(cv::Rect(48, 0, 48, 80)).setTo(cv::Scalar::all(160));  // a wall's end in mid window
  const auto f = appearance_features(test::block_of(picture), kWindow);
  EXPECT_EQ(feature(f, "brightness_stands_out"), 0.0);
  EXPECT_GT(feature(f, "brightness_bands_differ"), 0.5);
  EXPECT_LT(feature(f, "brightness_step_weak"), 0.01);
}

TEST(Appearance, TextureAcrossIsNotTextureAlong) {
  cv::Mat picture(80, 96, CV_8UC3, cv::Scalar::all(100));
  for (int x = 0; x < picture.cols; x += 4)
    picture(cv::Rect(x, 0, 2, 80)).setTo(cv::Scalar::all(50));
  const auto upright = appearance_features(test::block_of(picture), kWindow);
  EXPECT_GT(feature(upright, "gradient_across"), feature(upright, "gradient_along") + 2.0);
  EXPECT_GT(feature(upright, "brightness_in_columns"), 0.99);
}

TEST(Appearance, ExposureAndWhiteBalanceCancel) {
  const AppearanceConfig model = some_model();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const cv::Mat picture = 0.6 * test::busy_picture(96, 80, seed) + cv::Scalar(15, 20, 30);
    const auto as_is = appearance_features(test::block_of(picture), kWindow);
    const double confidence = appearance_confidence(as_is, model);
    for (const auto& [blue, green, red] :
         {std::array{0.6, 0.6, 0.6}, {1.3, 1.3, 1.3}, {0.7, 1.0, 1.4}, {1.4, 1.0, 0.7}}) {
      const auto lit =
          appearance_features(test::block_of(in_light(picture, blue, green, red)), kWindow);
      EXPECT_NEAR(appearance_confidence(lit, model), confidence, 0.03)
          << "seed " << seed << " light " << blue << " " << green << " " << red;
    }
  }
}

TEST(Appearance, AWeakChannelBringsLittleNoiseIntoBrightness) {
  // Pictures of one colour with noise of 3 grey levels in each channel, one pixel per cell of the
  // grid. Luma's noise is 3 sqrt(sum of (weight / mean)^2) relative to the light; neighbours differ
  // by 2 / sqrt(pi) of that on average, their logs by 1 / 1.1 of it.
  constexpr PixelRect window{32, 10, 8, 16};
  for (const auto& [blue, green, red] : {std::array{100, 100, 100}, {25, 100, 160}}) {
    cv::RNG random(5);
    double gradient = 0.0;
    constexpr int kPictures = 200;
    for (int i = 0; i < kPictures; ++i) {
      cv::Mat noise(40, 72, CV_32FC3), picture;
      random.fill(noise, cv::RNG::NORMAL, 0.0, 3.0);
      cv::Mat(noise + cv::Scalar(blue, green, red)).convertTo(picture, CV_8UC3);
      const auto f = appearance_features(test::block_of(picture), window);
      gradient += (std::exp(feature(f, "gradient_along")) - 0.02) / kPictures;
    }
    const double noise = 3.0 * std::hypot(0.114 / blue, 0.587 / green, 0.299 / red);
    EXPECT_NEAR(gradient, 2.0 / std::sqrt(CV_PI) * noise / 1.1, 0.05 * noise) << blue;
  }
}

TEST(Appearance, CellsKeepFractionsOfAGreyLevel) {
  // Rows of 10 and 11 grey levels: a cell of four rows and two columns is 10.5, one of half-covered
  // rows in between; rounded to whole levels it would be off by 5 %.
  cv::Mat picture(80, 96, CV_8UC3, cv::Scalar::all(10));
  for (int y = 0; y < picture.rows; y += 2) picture.row(y).setTo(cv::Scalar::all(11));
  cv::Mat brighter = picture.clone();
  brighter(cv::Rect(kWindow.x_px, 0, kWindow.width_px, picture.rows)) += cv::Scalar::all(1);
  const auto f = appearance_features(test::block_of(brighter), kWindow);
  const double mean = (2.0 * 10.5 + 11.5) / 3.0;
  EXPECT_NEAR(feature(f, "brightness_contrast"),
              std::log(11.5 / mean + 0.1) - std::log(10.5 / mean + 0.1), 1e-5);
}

TEST(Appearance, AMirrorChangesNothing) {
  const cv::Mat picture = test::busy_picture(96, 80, 3);
  cv::Mat mirrored;
  cv::flip(picture, mirrored, 1);
  PixelRect there = kWindow;
  there.x_px = picture.cols - kWindow.x_px - kWindow.width_px;
  const auto f = appearance_features(test::block_of(picture), kWindow);
  const auto g = appearance_features(test::block_of(mirrored), there);
  for (std::size_t i = 0; i < f.size(); ++i) {
    EXPECT_NEAR(f[i], g[i], 1e-5) << kAppearanceFeatureNames[i];
  }
}

TEST(Appearance, SizeInThePictureHardlyMatters) {
  const cv::Mat small = bar({60, 90, 140}, {90, 60, 50});
  cv::Mat large;
  cv::resize(small, large, {}, 3, 3, cv::INTER_NEAREST);
  const auto f = appearance_features(test::block_of(small), kWindow);
  const auto g = appearance_features(test::block_of(large), {120, 60, 48, 96});
  for (std::size_t i = 0; i < f.size(); ++i) {
    EXPECT_NEAR(f[i], g[i], 0.01) << kAppearanceFeatureNames[i];
  }
}

TEST(Appearance, ReadsOnlyItsRowsOfThePicture) {
  const cv::Mat picture = test::busy_picture(96, 80, 5);
  const PixelRect whole{0, 0, 96, 80};
  const PixelRect area = appearance_reading_area(kWindow, whole);
  EXPECT_TRUE(area.contains(kWindow));
  EXPECT_EQ(appearance_features(test::block_of(picture), kWindow),
            appearance_features(test::block_of(picture, area), kWindow));
}

TEST(Appearance, ABandBeyondThePictureIsTheOtherOne) {
  // Left of the window is nothing; what is right of it stands in, so the bar stands out still.
  cv::Mat picture(80, 96, CV_8UC3, cv::Scalar::all(60));
  picture(cv::Rect(0, 0, 16, 80)).setTo(cv::Scalar::all(120));
  const auto f = appearance_features(test::block_of(picture), {0, 20, 16, 32});
  EXPECT_NEAR(feature(f, "brightness_stands_out"), std::log(1.6) - std::log(0.85), 1e-5);
  EXPECT_NEAR(feature(f, "brightness_bands_differ"), 0.0, 1e-6);
  // A window as wide as the picture has no band at all.
  const auto alone = appearance_features(test::block_of(picture), {0, 20, 96, 32});
  for (const double value : alone) EXPECT_TRUE(std::isfinite(value));
}

TEST(Appearance, EveryPictureHasFiniteFeatures) {
  for (const int level : {0, 1, 255}) {
    const auto f = appearance_features(
        test::block_of(cv::Mat(80, 96, CV_8UC3, cv::Scalar::all(level))), kWindow);
    for (const double value : f) EXPECT_TRUE(std::isfinite(value)) << level;
  }
  const cv::Mat picture = test::busy_picture(96, 80, 9);
  for (const PixelRect& window : {PixelRect{7, 3, 1, 1}, PixelRect{95, 79, 1, 1},
                                  PixelRect{0, 0, 96, 80}, PixelRect{30, 0, 2, 80}}) {
    for (const double value : appearance_features(test::block_of(picture), window)) {
      EXPECT_TRUE(std::isfinite(value));
    }
  }
}

TEST(Appearance, RefusesWindowsBeyondThePixels) {
  const auto block = test::block_of(test::busy_picture(96, 80, 1));
  EXPECT_THROW(appearance_features(block, {90, 0, 10, 10}), std::invalid_argument);
  EXPECT_THROW(appearance_features(block, {10, 10, 0, 10}), std::invalid_argument);
}

TEST(Appearance, ConfidenceIsTheLogisticOfTheWeightedFeatures) {
  AppearanceConfig config = some_model();
  config.weights.assign(kNumAppearanceFeatures, 0.0);
  config.weights[2] = 1.5;
  config.bias = -0.25;
  AppearanceFeatures features{};
  features[2] = 1.1;  // two standard deviations above the mean
  EXPECT_NEAR(appearance_log_odds(features, config), 2.75, 1e-12);
  EXPECT_NEAR(appearance_confidence(features, config), 1.0 / (1.0 + std::exp(-2.75)), 1e-12);
  config.squares.assign(kNumAppearanceFeatures, 0.0);
  config.squares[2] = -0.5;
  EXPECT_NEAR(appearance_log_odds(features, config), 2.75 - 0.5 * (2.0 * 2.0 - 1.0), 1e-12);
  features[2] = config.mean[2] - 7.0 * config.scale[2];  // squares reach three
  EXPECT_NEAR(appearance_log_odds(features, config), -0.25 - 7.0 * 1.5 - 0.5 * 8.0, 1e-12);
  config.squares.pop_back();
  EXPECT_THROW(appearance_confidence(features, config), std::invalid_argument);
  config.squares.clear();
  config.weights.pop_back();
  EXPECT_THROW(appearance_confidence(features, config), std::invalid_argument);
  EXPECT_THROW(appearance_confidence(features, AppearanceConfig()), std::invalid_argument);
}

/// Largest difference to what OpenCV makes of the same picture in floating point.
double difference(const cv::Mat& pixels, int rows, int cols) {
  cv::Mat values, truth;
  pixels.convertTo(values, CV_32FC3);
  cv::resize(values, truth, {cols, rows}, 0, 0, cv::INTER_AREA);
  return cv::norm(area_grid(pixels, rows, cols), truth, cv::NORM_INF);
}

TEST(AreaGrid, IsTheMeanOverEachCellAsOpenCvHasIt) {
  cv::RNG random(7);
  for (int i = 0; i < 300; ++i) {
    cv::Mat whole(random.uniform(4, 130), random.uniform(4, 90), CV_8UC3);
    random.fill(whole, cv::RNG::UNIFORM, 0, 256);
    // a part of a picture, whose rows do not follow each other in memory
    const cv::Mat pixels = whole(cv::Rect(1, 1, whole.cols - 2, whole.rows - 2));
    EXPECT_LT(difference(pixels, 16, 8), 1e-3) << pixels.rows << " x " << pixels.cols;
  }
}

TEST(AreaGrid, AFractionOfAPixelCountsByItsFraction) {
  // Three columns on two cells: the middle one belongs to both by halves.
  cv::Mat pixels(1, 3, CV_8UC3);
  pixels.at<cv::Vec3b>(0, 0) = {0, 30, 90};
  pixels.at<cv::Vec3b>(0, 1) = {60, 60, 60};
  pixels.at<cv::Vec3b>(0, 2) = {120, 0, 30};
  const cv::Mat grid = area_grid(pixels, 1, 2);
  EXPECT_LT(cv::norm(grid.at<cv::Vec3f>(0, 0), cv::Vec3f(20, 40, 80)), 1e-3);
  EXPECT_LT(cv::norm(grid.at<cv::Vec3f>(0, 1), cv::Vec3f(100, 20, 40)), 1e-3);
}

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

PixelBlock block(std::uint8_t blue, std::uint8_t green, std::uint8_t red, int num_pixels = 16) {
  PixelBlock pixels;
  pixels.area = {10, 20, num_pixels, 1};
  for (int i = 0; i < num_pixels; ++i) pixels.bgr.insert(pixels.bgr.end(), {blue, green, red});
  return pixels;
}

TEST(Light, MeasuresTheLogsOfChannels) {
  const auto light = window_light(block(50, 100, 200), {12, 20, 8, 1});
  ASSERT_TRUE(light);
  EXPECT_NEAR(light->blue, std::log(0.5), 1e-12);
  EXPECT_NEAR(light->red, std::log(2.0), 1e-12);
  EXPECT_NEAR(light->green, std::log(100.0), 1e-12);
}

TEST(Light, ClippedAndDarkPixelsTellNothing) {
  EXPECT_FALSE(window_light(block(50, 100, 255), {10, 20, 16, 1}));
  EXPECT_FALSE(window_light(block(0, 100, 200), {10, 20, 16, 1}));
  PixelBlock pixels = block(50, 100, 200);
  for (std::size_t i = 0; i < 3 * 12; i += 3) pixels.bgr[i] = 255;  // a quarter is left
  const auto light = window_light(pixels, pixels.area);
  ASSERT_TRUE(light);
  EXPECT_NEAR(light->blue, std::log(0.5), 1e-12);
  EXPECT_THROW(window_light(pixels, {9, 20, 4, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace orchard::vision
