// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/album/album.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

namespace orchard::mapping {
namespace {

/// A camera that looks straight ahead from the scanner, which is base; f = 250 px.
detection::Rig rig() {
  geometry::CameraConfig camera;
  camera.extrinsics.delta_m = {0.0, 0.0, 0.0};
  return {laser::LaserConfig(), camera, detection::DetectorConfig()};
}

/// Where the axis of something `ahead_m` and `left_m` of the camera is, by the pinhole's equation.
double column_px(double ahead_m, double left_m) { return 159.5 - 250.0 * left_m / ahead_m; }

/// A striped trunk on even ground; the softer the stripes, the less can be seen.
vision::Image picture(std::int64_t utime, double trunk_px, double contrast = 80.0) {
  vision::Image image;
  image.utime = utime;
  image.width_px = 320;
  image.height_px = 240;
  image.encoding = vision::Encoding::kBgr8;
  image.data.resize(3u * 320u * 240u, 120);
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      if (std::abs(x - trunk_px) > 12.0) continue;
      const double value = 120.0 + contrast * std::sin(0.6 * y) * std::cos(0.5 * x);
      for (std::size_t c = 0; c < 3; ++c) {
        image.data[3u * static_cast<std::size_t>(320 * y + x) + c] =
            static_cast<std::uint8_t>(value);
      }
    }
  }
  return image;
}

pose::PoseEstimate at_origin(std::int64_t utime) {
  pose::PoseEstimate pose;
  pose.utime = utime;
  return pose;
}

TEST(Framing, TheAxisIsInTheMiddleAndTheFrameInThePicture) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> ahead_m(0.6, 6.0), left_m(-2.0, 2.0), width_m(0.05, 0.4);
  int num_framed = 0;
  for (int i = 0; i < 2000; ++i) {
    const Subject subject{ahead_m(random), left_m(random), width_m(random), 0};
    const Framing framing = frame_subjects({subject}, rig(), {}, 0.0).front();
    if (framing.frame.empty()) continue;
    ++num_framed;
    const vision::PixelRect& f = framing.frame;
    EXPECT_TRUE((vision::PixelRect{0, 0, 320, 240}).contains(f));
    EXPECT_TRUE(f.contains(framing.trunk));
    EXPECT_NEAR(f.x_px + 0.5 * (f.width_px - 1), column_px(subject.x_base_m, subject.y_base_m),
                1.0);
    EXPECT_GE(f.width_px, 2.0 * 250.0 * subject.width_m / subject.x_base_m - 1.0)
        << "twice as wide as the trunk";
  }
  EXPECT_GT(num_framed, 700);
}

TEST(Framing, TheMotionUntilTheExposureIsTakenIntoAccount) {
  const Subject subject{3.0, 0.5, 0.1, 0};
  const detection::Motion motion{0, 1.0, 0.0};  // a metre a second, straight on
  const vision::PixelRect frame = frame_subjects({subject}, rig(), motion, 0.5)[0].frame;
  EXPECT_NEAR(frame.x_px + 0.5 * (frame.width_px - 1), column_px(2.5, 0.5), 1.0);
}

TEST(Framing, WhatANearerThingHidesIsNotFramedAndWhatItTouchesIsWorthLess) {
  const Subject far_one{4.0, 0.0, 0.15, 0};
  const auto hidden = frame_subjects({far_one, {2.0, 0.02, 0.2, 0}}, rig(), {}, 0.0);
  EXPECT_TRUE(hidden[0].frame.empty());
  EXPECT_FALSE(hidden[1].frame.empty()) << "the nearer one is in full view";
  EXPECT_FALSE(hidden[1].is_hidden);
  const auto touched = frame_subjects({far_one, {2.0, 0.10, 0.15, 0}}, rig(), {}, 0.0);
  EXPECT_FALSE(touched[0].frame.empty());
  EXPECT_TRUE(touched[0].is_hidden);
  const vision::Image image = picture(1, column_px(4.0, 0.0));
  vision::PictureReader reader(image);
  EXPECT_LT(quality(touched[0], reader),
            0.5 * quality(frame_subjects({far_one}, rig(), {}, 0.0)[0], reader));
  const Subject behind{-2.0, 0.0, 0.1, 0};
  EXPECT_TRUE(frame_subjects({behind}, rig(), {}, 0.0)[0].frame.empty());
}

TEST(Framing, FewerDetailsAreWorthLess) {
  const vision::Image sharp = picture(1, column_px(3.0, 0.0));
  vision::Image soft = sharp;
  for (std::size_t i = 3 * 4; i + 3 * 4 < soft.data.size(); ++i) {  // over nine columns
    int sum = 0;
    for (int k = -4; k <= 4; ++k) sum += sharp.data[i + static_cast<std::size_t>(3 * (k + 4)) - 12];
    soft.data[i] = static_cast<std::uint8_t>(sum / 9);
  }
  const Framing framing = frame_subjects({{3.0, 0.0, 0.1, 0}}, rig(), {}, 0.0)[0];
  vision::PictureReader of_sharp(sharp), of_soft(soft);
  EXPECT_GT(quality(framing, of_sharp), quality(framing, of_soft));
  EXPECT_GT(quality(framing, of_soft), 0.0);
}

/// Twenty trees along the way, each seen ten times; every scan has a picture.
struct Drive {
  std::vector<Subject> subjects;
  std::vector<std::int64_t> utimes;
  std::vector<vision::Image> pictures;
  Drive() {
    for (int i = 0; i < 200; ++i) {
      const double ahead_m = 4.0 - 0.2 * (i % 10);
      subjects.push_back({ahead_m, 0.3, 0.1, 0});
      utimes.push_back(1000 + 300000 * i);
      pictures.push_back(picture(utimes.back(), column_px(ahead_m, 0.3)));
    }
  }
  void scan(Album& album, std::size_t i) const {
    pose::PoseEstimate pose = at_origin(utimes[i]);
    pose.x_m = 2.0 * static_cast<double>(i / 10) + 0.2 * static_cast<double>(i % 10);
    album.add_scan(utimes[i], pictures[i].utime, pose, {}, {subjects[i]});
  }
};

std::vector<PlacedPhotograph> photographs_of(const Album& album) {
  return album.photographs([](std::int64_t utime) {
    pose::PoseEstimate pose = at_origin(utime);
    const auto i = static_cast<double>((utime - 1000) / 300000);
    pose.x_m = 2.0 * std::floor(i / 10.0) + 0.2 * std::fmod(i, 10.0);
    return std::optional(pose);
  });
}

std::string bytes_of(const std::vector<PlacedPhotograph>& photographs) {
  std::string bytes;
  for (const PlacedPhotograph& it : photographs) {
    bytes += std::to_string(it.photograph.image_utime) + " " + std::to_string(it.x_m) + " ";
    bytes.append(it.photograph.jpeg.begin(), it.photograph.jpeg.end());
  }
  return bytes;
}

TEST(Album, HasOneOfEachWhateverTheOrderOfScansAndPictures) {
  const Drive drive;
  std::string first;
  for (unsigned seed = 0; seed < 5; ++seed) {
    Album album(AlbumConfig{}, rig());
    std::mt19937_64 random(seed);
    std::size_t scan = 0, next = 0;
    while (scan < 200 || next < 200) {  // each channel in its order, the one or the other ahead
      const bool is_scan = next == 200 || (scan < 200 && random() % 2 == 0);
      if (is_scan) {
        drive.scan(album, scan++);
      } else {
        album.add_picture(drive.pictures[next++]);
      }
    }
    album.flush();
    const auto photographs = photographs_of(album);
    EXPECT_EQ(photographs.size(), 20u);
    if (seed == 0) first = bytes_of(photographs);
    EXPECT_TRUE(bytes_of(photographs) == first) << seed;
  }
}

TEST(Album, NeverTakesMoreThanItMay) {
  const Drive drive;
  AlbumConfig config;
  config.max_mb = 0.012;
  Album album(config, rig());
  for (std::size_t i = 0; i < 200; ++i) {
    album.add_picture(drive.pictures[i]);
    drive.scan(album, i);
    ASSERT_LE(album.num_bytes(), 12000u) << i;
  }
  EXPECT_GE(photographs_of(album).size(), 3u);
}

TEST(Album, DamagedPicturesAndLostOnesHoldNothingUp) {
  const Drive drive;
  Album album(AlbumConfig{}, rig());
  for (std::size_t i = 0; i < 200; ++i) {
    vision::Image image = drive.pictures[i];
    if (i % 3 == 0) image.data.resize(17);
    if (i % 3 == 1) image.encoding = vision::Encoding::kJpeg;
    if (i % 7 != 0) album.add_picture(image);
    drive.scan(album, i);
  }
  EXPECT_EQ(photographs_of(album).size(), 20u);
}

TEST(ChoosePhotographs, TheBestOfWhatStandsThereAndTreesFirst) {
  const auto photograph = [](double x_m, double is_worth, std::size_t num_bytes) {
    PlacedPhotograph it;
    it.photograph.quality = is_worth;
    it.photograph.jpeg.resize(num_bytes);
    it.x_m = x_m;
    return it;
  };
  std::vector<Landmark> landmarks(3);
  for (int i = 0; i < 3; ++i) {
    landmarks[static_cast<std::size_t>(i)].id = i + 1;
    landmarks[static_cast<std::size_t>(i)].x_m = i;
    landmarks[static_cast<std::size_t>(i)].label =
        i == 0 ? detection::Label::kObject : detection::Label::kTree;
  }
  const std::vector<PlacedPhotograph> all{photograph(0.1, 9.0, 50), photograph(0.9, 2.0, 40),
                                          photograph(1.2, 3.0, 40), photograph(2.0, 1.0, 30),
                                          photograph(5.0, 9.0, 10)};
  const auto entries = choose_photographs(landmarks, all, 1000);
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[0].landmark_id, 1);
  EXPECT_EQ(entries[1].photograph, &all[2].photograph) << "the better of two";
  const auto few = choose_photographs(landmarks, all, 80);
  ASSERT_EQ(few.size(), 2u);
  EXPECT_EQ(few[0].landmark_id, 2);
  EXPECT_EQ(few[1].landmark_id, 3);
}

}  // namespace
}  // namespace orchard::mapping
