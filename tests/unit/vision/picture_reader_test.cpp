// SPDX-License-Identifier: BSD-3-Clause
#include "vision/picture_reader.hpp"

#include <gtest/gtest.h>

#include "unit/vision/test_pictures.hpp"
#include "vision/decode.hpp"

namespace orchard::vision {
namespace {

using test::busy_picture;
using test::image_of;

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
