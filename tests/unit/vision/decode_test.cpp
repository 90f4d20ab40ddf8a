// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <turbojpeg.h>
#include <cstring>

#include "unit/vision/test_pictures.hpp"
#include "vision/decode.hpp"

namespace orchard::vision {
namespace {

using test::busy_picture;
using test::image_of;
using test::jpeg_of;

void expect_equal_to_opencv(const std::vector<std::uint8_t>& bytes, const PixelRect& region) {
  const cv::Mat whole = cv::imdecode(bytes, cv::IMREAD_COLOR);
  const auto block = decode_jpeg_region(bytes.data(), bytes.size(), whole.cols, whole.rows, region);
  ASSERT_TRUE(block.has_value());
  EXPECT_EQ(block->bgr, test::block_of(whole, region).bgr)
      << region.x_px << " " << region.y_px << " " << region.width_px << " " << region.height_px;
}

TEST(JpegRegion, EqualsOpenCvsPixelsForAnyRegion) {
  std::mt19937 random(1);
  for (const bool progressive : {false, true}) {
    for (const auto& size : {std::pair{320, 240}, std::pair{321, 239}, std::pair{47, 33}}) {
      const auto bytes = jpeg_of(busy_picture(size.first, size.second, 7), 88, progressive);
      expect_equal_to_opencv(bytes, {0, 0, size.first, size.second});
      for (int i = 0; i < 150; ++i) {
        PixelRect region;
        region.x_px = static_cast<int>(random() % static_cast<unsigned>(size.first));
        region.y_px = static_cast<int>(random() % static_cast<unsigned>(size.second));
        region.width_px =
            1 + static_cast<int>(random() % static_cast<unsigned>(size.first - region.x_px));
        region.height_px =
            1 + static_cast<int>(random() % static_cast<unsigned>(size.second - region.y_px));
        expect_equal_to_opencv(bytes, region);
      }
    }
  }
}

/// A JPEG with chroma samples as large as `subsampling` (TJSAMP_...) says; cameras differ in it.
std::vector<std::uint8_t> jpeg_subsampled(const cv::Mat& picture, int subsampling) {
  const tjhandle codec = tjInitCompress();
  unsigned char* data = nullptr;
  unsigned long size = 0;
  tjCompress2(codec, picture.data, picture.cols, 0, picture.rows, TJPF_BGR, &data, &size,
              subsampling, 88, 0);
  const std::vector<std::uint8_t> bytes(data, data + size);
  tjFree(data);
  tjDestroy(codec);
  return bytes;
}

TEST(JpegRegion, EqualsOpenCvsPixelsWhateverTheChromaSamplesSpan) {
  std::mt19937 random(2);
  const auto upto = [&random](int most) {
    return static_cast<int>(random() % static_cast<unsigned>(most));
  };
  for (const int subsampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420, TJSAMP_440, TJSAMP_411}) {
    const auto bytes = jpeg_subsampled(busy_picture(157, 101, 9), subsampling);
    ASSERT_FALSE(bytes.empty());
    for (int i = 0; i < 120; ++i) {
      const int x_px = upto(157), y_px = upto(101);
      expect_equal_to_opencv(bytes, {x_px, y_px, 1 + upto(157 - x_px), 1 + upto(101 - y_px)});
    }
  }
}

TEST(JpegRegion, TakesAGreyJpegAsOpenCvDoes) {
  cv::Mat grey;
  cv::cvtColor(busy_picture(64, 48, 3), grey, cv::COLOR_BGR2GRAY);
  expect_equal_to_opencv(jpeg_of(grey), {10, 20, 30, 7});
}

TEST(JpegRegion, RefusesAnotherSizeThanStatedAndRegionsOutsideThePicture) {
  const auto bytes = jpeg_of(busy_picture(64, 48, 3));
  EXPECT_FALSE(decode_jpeg_region(bytes.data(), bytes.size(), 48, 64, {0, 0, 8, 8}));
  EXPECT_TRUE(decode_jpeg_region(bytes.data(), bytes.size(), 64, 48, {0, 0, 8, 8}));
  for (const PixelRect& region : {PixelRect{60, 0, 8, 8}, PixelRect{-1, 0, 8, 8},
                                  PixelRect{0, 0, 0, 8}, PixelRect{0, 47, 8, 2}}) {
    EXPECT_FALSE(decode_jpeg_region(bytes.data(), bytes.size(), 64, 48, region));
  }
}

TEST(JpegRegion, RefusesWhatIsNoJpeg) {
  const std::vector<std::uint8_t> zeros(1000, 0);
  EXPECT_FALSE(decode_jpeg_region(zeros.data(), zeros.size(), 64, 48, {0, 0, 8, 8}));
  EXPECT_FALSE(decode_jpeg_region(zeros.data(), 0, 64, 48, {0, 0, 8, 8}));
  EXPECT_FALSE(decode_jpeg_region(nullptr, 0, 64, 48, {0, 0, 8, 8}));
  std::vector<std::uint8_t> png;
  cv::imencode(".png", busy_picture(64, 48, 3), png);
  EXPECT_FALSE(decode_jpeg_region(png.data(), png.size(), 64, 48, {0, 0, 8, 8}));
}

TEST(JpegRegion, RefusesAJpegCutShortBeforeTheRegionEnds) {
  for (const bool progressive : {false, true}) {
    const auto bytes = jpeg_of(busy_picture(64, 48, 3), 88, progressive);
    for (std::size_t size = 0; size < bytes.size() * 9 / 10; size += 7) {
      EXPECT_FALSE(decode_jpeg_region(bytes.data(), size, 64, 48, {0, 0, 64, 48})) << size;
    }
  }
}

TEST(JpegRegion, SurvivesEveryKindOfDamage) {
  std::mt19937 random(11);
  int refused = 0;
  for (const bool progressive : {false, true}) {
    const auto bytes = jpeg_of(busy_picture(96, 64, 3), 80, progressive);
    for (int i = 0; i < 1500; ++i) {
      auto damaged = bytes;
      for (unsigned k = 0; k < 1 + random() % 4; ++k) {
        damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
      }
      const auto block =
          decode_jpeg_region(damaged.data(), damaged.size(), 96, 64, {10, 10, 60, 40});
      if (!block) ++refused;
    }
  }
  EXPECT_GT(refused, 100);  // damage inside a coded block can go unseen
}

TEST(JpegRegion, RefusesAnAbsurdNumberOfScans) {
  // A progressive picture whose last scan is repeated: each repetition would be decoded in full.
  const auto bytes = jpeg_of(busy_picture(64, 48, 3), 88, true);
  std::vector<std::size_t> scans;
  for (std::size_t i = 2; i + 1 < bytes.size(); ++i) {
    if (bytes[i] == 0xFF && bytes[i + 1] == 0xDA) scans.push_back(i);
  }
  ASSERT_GT(scans.size(), 2u);
  const std::vector<std::uint8_t> last(bytes.begin() + static_cast<std::ptrdiff_t>(scans.back()),
                                       bytes.end() - 2);
  auto bomb = bytes;
  bomb.resize(bomb.size() - 2);
  for (int i = 0; i < 2000; ++i) bomb.insert(bomb.end(), last.begin(), last.end());
  bomb.insert(bomb.end(), {0xFF, 0xD9});
  EXPECT_FALSE(decode_jpeg_region(bomb.data(), bomb.size(), 64, 48, {0, 0, 8, 8}));
}

TEST(Decode, CutsRawPictures) {
  const cv::Mat picture = busy_picture(40, 30, 5);
  const PixelRect region{7, 9, 11, 13};
  const auto block = decode(test::image_of(picture, Encoding::kBgr8), region);
  ASSERT_TRUE(block.has_value());
  EXPECT_EQ(block->bgr, test::block_of(picture, region).bgr);
}

TEST(Decode, RefusesPicturesThatContradictTheirSizeOrHaveNoColour) {
  const cv::Mat picture = busy_picture(40, 30, 5);
  Image image = test::image_of(picture, Encoding::kBgr8);
  image.data.pop_back();
  EXPECT_FALSE(decode(image, {0, 0, 8, 8}));
  image.width_px = -40;
  EXPECT_FALSE(decode(image, {0, 0, 8, 8}));
  Image grey;
  grey.width_px = 40;
  grey.height_px = 30;
  grey.encoding = Encoding::kGray8;
  grey.data.resize(1200);
  EXPECT_FALSE(decode(grey, {0, 0, 8, 8}));
}

void expect_as_decoded(PictureReader& reader, const PixelRect& region) {
  const auto read = reader.read(region);
  const auto decoded = decode(reader.image(), region);
  ASSERT_EQ(read.has_value(), decoded.has_value());
  if (!decoded) return;
  EXPECT_TRUE(read->area.contains(region) && region.contains(read->area));
  EXPECT_EQ(read->bgr, decoded->bgr);
}

TEST(PictureReader, GivesThePixelsOfEachPartWhateverElseIsWanted) {
  for (const Encoding encoding : {Encoding::kJpeg, Encoding::kBgr8}) {
    const Image image = image_of(busy_picture(160, 120, 3), encoding);
    PictureReader reader(image);
    expect_as_decoded(reader, {30, 40, 50, 20});  // nothing is expected
    reader.expect({10, 50, 20, 30});
    reader.expect({100, 30, 40, 20});
    expect_as_decoded(reader, {20, 45, 30, 20});
    expect_as_decoded(reader, {10, 50, 20, 30});
    expect_as_decoded(reader, {100, 30, 40, 20});
    expect_as_decoded(reader, {0, 100, 160, 20});  // outside of all that was expected
    expect_as_decoded(reader, {10, 50, 20, 30});
  }
}

TEST(PictureReader, GivesNoneWhereThereIsNoPart) {
  const Image image = image_of(busy_picture(64, 48, 3), Encoding::kJpeg);
  PictureReader reader(image);
  EXPECT_FALSE(reader.read({}));
  EXPECT_FALSE(reader.read({60, 0, 8, 8}));
  reader.expect({0, 0, 16, 16});
  EXPECT_FALSE(reader.read({}));
  EXPECT_FALSE(reader.read({60, 0, 8, 8}));
}

TEST(PictureReader, DamageInWhatOthersExpectCostsNothing) {
  Image image = image_of(busy_picture(160, 120, 3), Encoding::kJpeg);
  image.data.resize(image.data.size() / 2);
  const PixelRect above{20, 5, 60, 20}, below{20, 90, 60, 20};
  ASSERT_TRUE(decode(image, above));
  ASSERT_FALSE(decode(image, below));
  PictureReader reader(image);
  reader.expect(below);
  expect_as_decoded(reader, above);
  EXPECT_FALSE(reader.read(below));
  expect_as_decoded(reader, above);
}

}  // namespace
}  // namespace orchard::vision
