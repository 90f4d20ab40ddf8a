// SPDX-License-Identifier: BSD-3-Clause
#include "io/bag/bag_picture.hpp"

#include <cstring>
#include <map>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

#include "io/recording/jpeg_file.hpp"
#include "io/recording/picture_file.hpp"

namespace orchard::io {
namespace {

constexpr std::uint32_t kMaxPixels_px = 16384;  // per side

/// Pixel layout of an encoding and the OpenCV conversion to BGR; -1: none needed.
struct Pixels {
  int type;
  int conversion;
};

/// Encodings by sensor_msgs/image_encodings. OpenCV names a Bayer pattern by its second row, ROS by
/// its first.
const std::map<std::string, Pixels>& encodings() {
  static const std::map<std::string, Pixels> kEncodings{
      {"bgr8", {CV_8UC3, -1}},
      {"8UC3", {CV_8UC3, -1}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2BGR}},
      {"bgra8", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2BGR}},
      {"mono8", {CV_8UC1, -1}},
      {"8UC1", {CV_8UC1, -1}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2BGR}}};
  return kEncodings;
}

vision::Image image_of(const cv::Mat& pixels, std::int64_t utime) {
  vision::Image image;
  image.utime = utime;
  image.width_px = pixels.cols;
  image.height_px = pixels.rows;
  image.encoding = pixels.channels() == 1 ? vision::Encoding::kGray8 : vision::Encoding::kBgr8;
  const std::size_t row_bytes = static_cast<std::size_t>(pixels.cols) * pixels.elemSize();
  image.data.resize(row_bytes * static_cast<std::size_t>(pixels.rows));
  for (int row = 0; row < pixels.rows; ++row) {
    std::memcpy(image.data.data() + row_bytes * static_cast<std::size_t>(row), pixels.ptr(row),
                row_bytes);
  }
  return image;
}

bool is_sane(std::uint32_t width_px, std::uint32_t height_px) {
  return width_px > 0 && height_px > 0 && width_px <= kMaxPixels_px && height_px <= kMaxPixels_px;
}

std::variant<vision::Image, ros::NotUsed> compressed(const ros::Picture& picture) {
  auto image = jpeg_image(picture.data, picture.num_bytes);
  if (!image) image = png_image(picture.data, picture.num_bytes, PngColours::kAsTheyAre);
  if (image) {
    image->utime = picture.utime;
    return std::move(*image);
  }
  return ros::NotUsed{
      "a compressed picture that is neither a colour or grey JPEG nor PNG (format \"" +
      picture.encoding.substr(0, 40) + "\")"};
}

}  // namespace

std::variant<vision::Image, ros::NotUsed> bag_picture(const ros::Picture& picture) {
  if (picture.width_px == 0 && picture.height_px == 0) return compressed(picture);
  const auto found = encodings().find(picture.encoding);
  if (found == encodings().end()) {
    return ros::NotUsed{"encoding " + picture.encoding.substr(0, 40) + " is not supported"};
  }
  const auto [type, conversion] = found->second;
  const std::uint64_t pixel_bytes = static_cast<std::uint64_t>(CV_ELEM_SIZE(type));
  const bool is_whole =
      is_sane(picture.width_px, picture.height_px) &&
      picture.row_bytes >= pixel_bytes * picture.width_px &&
      std::uint64_t{picture.height_px - 1} * picture.row_bytes + pixel_bytes * picture.width_px <=
          picture.num_bytes &&
      (type != CV_8UC2 || picture.width_px % 2 == 0) &&
      (picture.width_px >= 2 && picture.height_px >= 2);
  if (!is_whole) return ros::NotUsed{"a picture whose size does not match its data"};
  const cv::Mat given(static_cast<int>(picture.height_px), static_cast<int>(picture.width_px), type,
                      const_cast<std::uint8_t*>(picture.data), picture.row_bytes);
  if (conversion < 0) return image_of(given, picture.utime);
  cv::Mat bgr;
  cv::cvtColor(given, bgr, conversion);
  return image_of(bgr, picture.utime);
}

}  // namespace orchard::io
