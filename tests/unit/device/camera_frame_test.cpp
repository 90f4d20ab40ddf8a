// SPDX-License-Identifier: BSD-3-Clause
#include "device/camera/camera_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <random>

namespace orchard::device {
namespace {

/// Noise, which no JPEG makes small, over a slope.
cv::Mat scene(int width_px, int height_px, double noise_sd, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, noise_sd);
  cv::Mat picture(height_px, width_px, CV_8UC3);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      cv::Vec3b& pixel = picture.at<cv::Vec3b>(y, x);
      pixel[0] = cv::saturate_cast<std::uint8_t>(60 + noise(random));
      pixel[1] = cv::saturate_cast<std::uint8_t>(200.0 * x / width_px + noise(random));
      pixel[2] = cv::saturate_cast<std::uint8_t>(200.0 * y / height_px + noise(random));
    }
  }
  return picture;
}

CameraFrame jpeg_frame(const cv::Mat& picture, int quality) {
  CameraFrame frame;
  frame.utime = 77;
  frame.width_px = picture.cols;
  frame.height_px = picture.rows;
  cv::imencode(".jpg", picture, frame.data, {cv::IMWRITE_JPEG_QUALITY, quality});
  return frame;
}

vision::Image picture_of(PictureLimit& limit, CameraFrame frame) {
  auto fitted = limit.fit(std::move(frame));
  const auto* image = std::get_if<vision::Image>(&fitted);
  EXPECT_NE(image, nullptr);
  return image == nullptr ? vision::Image{} : *image;
}

std::string refused(PictureLimit& limit, CameraFrame frame) {
  auto fitted = limit.fit(std::move(frame));
  const auto* none = std::get_if<NoPicture>(&fitted);
  return none == nullptr ? "" : none->why;
}

TEST(PictureLimit, ACamerasOwnJpegPassesUnchanged) {
  PictureLimit limit(60000);
  CameraFrame frame = jpeg_frame(scene(320, 240, 5.0), 95);
  frame.data.resize(frame.data.size() + 100, 0);  // padding, as cameras send it
  const vision::Image image = picture_of(limit, frame);
  EXPECT_EQ(image.data, frame.data);
  EXPECT_EQ(image.utime, 77);
  EXPECT_EQ(limit.quality(), 0);
}

TEST(PictureLimit, QualityGoesDownUntilTheLimitIsKept) {
  const cv::Mat picture = scene(640, 480, 12.0);
  const CameraFrame frame = jpeg_frame(picture, 98);
  ASSERT_GT(frame.data.size(), 200000u);
  PictureLimit limit(60000);
  for (int i = 0; i < 4; ++i) {
    const vision::Image image = picture_of(limit, frame);
    EXPECT_LE(image.data.size(), 60000u);
    EXPECT_GT(image.data.size(), 50000u);  // and no further than needed
    const cv::Mat decoded = cv::imdecode(image.data, cv::IMREAD_COLOR);
    ASSERT_EQ(decoded.size(), picture.size());
    // The slope is still there.
    for (const cv::Rect& edge : {cv::Rect(0, 0, 64, 480), cv::Rect(576, 0, 64, 480)}) {
      EXPECT_NEAR(cv::mean(decoded(edge))[1], cv::mean(picture(edge))[1], 2.0);
    }
  }
  // A quieter scene gets its quality back.
  const CameraFrame quiet = jpeg_frame(scene(640, 480, 3.0), 100);
  ASSERT_GT(quiet.data.size(), 60000u);
  const int low = limit.quality();
  for (int i = 0; i < 20; ++i) EXPECT_LE(picture_of(limit, quiet).data.size(), 60000u);
  EXPECT_GT(limit.quality(), low + 10);
}

TEST(PictureLimit, WhatCannotBeMadeSmallIsRefused) {
  PictureLimit limit(5000);
  EXPECT_NE(refused(limit, jpeg_frame(scene(640, 480, 30.0), 95)).find("even with quality 25"),
            std::string::npos);
}

// ITU-R BT.601, full range as JPEG has it: Y = 0.299 R + 0.587 G + 0.114 B.
TEST(PictureLimit, YuyvKeepsItsColours) {
  CameraFrame frame;
  frame.format = PixelFormat::kYuyv;
  frame.width_px = 32;
  frame.height_px = 16;
  frame.row_bytes = 80;  // padded rows
  frame.data.assign(80 * 16, 0);
  const double red = 180, green = 60, blue = 30;
  const double y = 0.299 * red + 0.587 * green + 0.114 * blue;
  for (int row = 0; row < 16; ++row) {
    for (int i = 0; i < 32; i += 2) {
      std::uint8_t* pair = &frame.data[static_cast<std::size_t>(row * 80 + 2 * i)];
      pair[0] = pair[2] = static_cast<std::uint8_t>(std::lround(y));
      pair[1] = static_cast<std::uint8_t>(std::lround(128 + 0.564 * (blue - y)));
      pair[3] = static_cast<std::uint8_t>(std::lround(128 + 0.713 * (red - y)));
    }
  }
  PictureLimit limit(60000);
  const cv::Mat decoded = cv::imdecode(picture_of(limit, frame).data, cv::IMREAD_COLOR);
  ASSERT_EQ(decoded.cols, 32);
  EXPECT_NEAR(cv::mean(decoded)[2], red, 3.0);
  EXPECT_NEAR(cv::mean(decoded)[1], green, 3.0);
  EXPECT_NEAR(cv::mean(decoded)[0], blue, 3.0);
}

TEST(PictureLimit, BgrRgbAndGrey) {
  const cv::Mat picture = scene(64, 48, 0.0);
  PictureLimit limit(60000);
  for (const PixelFormat format : {PixelFormat::kBgr, PixelFormat::kRgb, PixelFormat::kGrey}) {
    CameraFrame frame;
    frame.format = format;
    frame.width_px = 64;
    frame.height_px = 48;
    frame.row_bytes = 64 * (format == PixelFormat::kGrey ? 1 : 3);
    frame.data.assign(picture.data, picture.data + frame.row_bytes * 48);
    const cv::Mat decoded = cv::imdecode(picture_of(limit, frame).data, cv::IMREAD_COLOR);
    ASSERT_EQ(decoded.cols, 64);
    if (format == PixelFormat::kGrey) continue;
    const int blue = format == PixelFormat::kBgr ? 0 : 2;
    EXPECT_NEAR(cv::mean(decoded)[blue], 60.0, 2.0);
    frame.data.pop_back();
    EXPECT_NE(refused(limit, frame), "");
  }
}

TEST(PictureLimit, DamagedFramesAreRefused) {
  PictureLimit limit(60000);
  CameraFrame frame = jpeg_frame(scene(320, 240, 5.0), 90);
  CameraFrame cut = frame;
  cut.data.resize(cut.data.size() / 2);
  EXPECT_EQ(refused(limit, cut), "an incomplete JPEG");
  CameraFrame empty = frame;
  empty.data.clear();
  EXPECT_EQ(refused(limit, empty), "an incomplete JPEG");
  PictureLimit tight(1000);
  CameraFrame other_size = frame;
  other_size.width_px = 640;
  EXPECT_EQ(refused(tight, other_size), "pixel data that does not match the size of the picture");
}

TEST(FrameWatch, TenPicturesTheSameAreAFrozenCamera) {
  FrameWatch watch;
  for (int i = 0; i < 9; ++i) {
    watch.add({1, 2, 3});
    EXPECT_FALSE(watch.is_frozen());
  }
  watch.add({1, 2, 3});
  EXPECT_TRUE(watch.is_frozen());
  watch.add({1, 2, 4});
  EXPECT_FALSE(watch.is_frozen());
}

}  // namespace
}  // namespace orchard::device
