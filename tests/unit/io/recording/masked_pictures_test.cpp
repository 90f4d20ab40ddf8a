// SPDX-License-Identifier: BSD-3-Clause
#include "io/recording/picture_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "io/file_error.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class MaskedPictures : public testing::Test {
 protected:
  MaskedPictures() {
    fs::create_directories(images_);
    fs::create_directories(masks_);
  }

  void write_image(const std::string& name, int width_px = 40, int height_px = 60) const {
    cv::imwrite(images_ + "/" + name, cv::Mat(height_px, width_px, CV_8UC3, {90, 80, 70}));
  }
  void write_mask(const std::string& name, const cv::Scalar& trunk_bgr = {0, 0, 128},
                  int width_px = 40, int height_px = 60) const {
    cv::Mat mask(height_px, width_px, CV_8UC3, cv::Scalar(0, 0, 0));
    mask(cv::Rect(0, 0, 10, height_px)).setTo(cv::Scalar(0, 128, 0));  // a branch
    mask(cv::Rect(15, 0, 8, height_px)).setTo(trunk_bgr);
    cv::imwrite(masks_ + "/" + name, mask);
  }
  std::string refusal(const std::string& name) const {
    try {
      const auto list = list_masked_pictures(images_, masks_, "");
      for (const auto& paths : list.pictures) {
        if (paths.name == name) read_masked_picture(paths);
      }
    } catch (const FileError& error) {
      return error.what();
    }
    return {};
  }
  std::string list_refusal(const std::string& only) const {
    try {
      list_masked_pictures(images_, masks_, only);
    } catch (const FileError& error) {
      return error.what();
    }
    return {};
  }
  std::vector<std::string> names(const std::string& only) const {
    std::vector<std::string> result;
    for (const auto& p : list_masked_pictures(images_, masks_, only).pictures) {
      result.push_back(p.name);
    }
    return result;
  }

  TestFolder folder_;
  const std::string images_ = folder_ / "images";
  const std::string masks_ = folder_ / "masks";
};

TEST_F(MaskedPictures, RedIsTrunkAndNothingElse) {
  write_image("007.jpg");
  write_mask("007.png");
  const auto list = list_masked_pictures(images_, masks_, "");
  ASSERT_EQ(list.pictures.size(), 1u);
  const MaskedPicture picture = read_masked_picture(list.pictures[0]);
  EXPECT_EQ(picture.pixels.area.width_px, 40);
  EXPECT_EQ(picture.pixels.area.height_px, 60);
  EXPECT_NEAR(picture.pixels.bgr[0], 90, 3);
  EXPECT_EQ(picture.mask.num_trunk_px(), 8 * 60);
  EXPECT_EQ(picture.mask.trunk[15], 1);
  EXPECT_EQ(picture.mask.trunk[14], 0);
  EXPECT_EQ(picture.mask.trunk[5], 0);
}

TEST_F(MaskedPictures, AreChosenByNumber) {
  for (const char* name : {"000", "001", "009", "010", "119"}) {
    write_image(std::string(name) + ".jpg");
    write_mask(std::string(name) + ".png");
  }
  EXPECT_THAT(names("000-009"), ElementsAre("000", "001", "009"));
  EXPECT_THAT(names("1"), ElementsAre("001"));
  EXPECT_THAT(names("0-0,010-200"), ElementsAre("000", "010", "119"));
  EXPECT_THAT(list_refusal("500-600"), HasSubstr("the numbers go from 000 to 119"));
  for (const char* only : {"9-0", "a", "1-", "-1", "1,,2", "1-2-3", "1 "}) {
    EXPECT_THAT(list_refusal(only), HasSubstr("must be picture numbers")) << only;
  }
}

TEST_F(MaskedPictures, APictureWithoutMaskIsNamed) {
  write_image("000.jpg");
  write_image("001.jpg");
  write_mask("001.png");
  EXPECT_THAT(list_masked_pictures(images_, masks_, "").without_mask, ElementsAre("000"));
  EXPECT_THAT(list_refusal("0"), HasSubstr("has no mask with the name of a picture, such as 000"));
}

TEST_F(MaskedPictures, FoldersWithoutPicturesAreRefused) {
  EXPECT_THAT(list_refusal(""), HasSubstr("images: has no picture"));
  write_image("000.jpg");
  EXPECT_THAT(list_refusal(""), HasSubstr("masks: has no picture"));
  EXPECT_THROW(list_masked_pictures(folder_ / "nowhere", masks_, ""), FileError);
}

TEST_F(MaskedPictures, WhatIsNoPictureOrDoesNotFitIsRefusedByName) {
  write_image("000.jpg");
  write_mask("000.png", {0, 0, 128}, 41);
  EXPECT_THAT(refusal("000"), HasSubstr("000.png: is 41 x 60 pixels, but its picture 40 x 60"));
  write_mask("000.png", {128, 0, 0});
  EXPECT_THAT(refusal("000"), HasSubstr("has no red pixel"));
  write_mask("000.png", {128, 128, 128});  // grey is not red
  EXPECT_THAT(refusal("000"), HasSubstr("has no red pixel"));
  write_bytes(masks_ + "/000.png", "no picture");
  EXPECT_THAT(refusal("000"), HasSubstr("000.png: is not a complete picture"));
  write_bytes(masks_ + "/000.png", "");
  EXPECT_THAT(refusal("000"), HasSubstr("0 bytes"));
  write_mask("000.png");
  const std::string jpeg = read_bytes(images_ + "/000.jpg");
  write_bytes(images_ + "/000.jpg", jpeg.substr(0, jpeg.size() / 2));
  EXPECT_THAT(refusal("000"), HasSubstr("000.jpg: is no"));
}

}  // namespace
}  // namespace orchard::io
