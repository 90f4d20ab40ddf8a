// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "vision/image.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::test {

/// Coloured noise over waves: every block of a JPEG of it differs from its neighbours.
inline cv::Mat busy_picture(int width_px, int height_px, unsigned seed) {
  std::mt19937 random(seed);
  cv::Mat picture(height_px, width_px, CV_8UC3);
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      auto& pixel = picture.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) {
        const double wave = 60.0 * std::sin(0.11 * x * (c + 1) + 0.07 * y * (3 - c));
        pixel[c] = cv::saturate_cast<std::uint8_t>(128.0 + wave + static_cast<int>(random() % 61));
      }
    }
  }
  return picture;
}

inline std::vector<std::uint8_t> jpeg_of(const cv::Mat& picture, int quality = 88,
                                         bool progressive = false) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", picture, bytes,
               {cv::IMWRITE_JPEG_QUALITY, quality, cv::IMWRITE_JPEG_PROGRESSIVE, progressive});
  return bytes;
}

inline vision::Image image_of(const cv::Mat& picture, vision::Encoding encoding) {
  vision::Image image;
  image.width_px = picture.cols;
  image.height_px = picture.rows;
  image.encoding = encoding;
  if (encoding == vision::Encoding::kJpeg) {
    image.data = jpeg_of(picture);
  } else {
    image.data.assign(picture.datastart, picture.dataend);
  }
  return image;
}

/// Blue, green, red of an area of a whole picture, as a block.
inline vision::PixelBlock block_of(const cv::Mat& picture, const vision::PixelRect& area) {
  const cv::Mat part =
      picture(cv::Rect(area.x_px, area.y_px, area.width_px, area.height_px)).clone();
  vision::PixelBlock block;
  block.area = area;
  block.bgr.assign(part.datastart, part.dataend);
  return block;
}

inline vision::PixelBlock block_of(const cv::Mat& picture) {
  return block_of(picture, {0, 0, picture.cols, picture.rows});
}

/// A colour by hue [deg], saturation and value in [0, 1].
inline cv::Vec3b bgr_of(double hue_deg, double saturation, double value) {
  const double k = std::fmod(hue_deg, 360.0) / 60.0;
  const double c = value * saturation, x = c * (1.0 - std::abs(std::fmod(k, 2.0) - 1.0));
  const double m = value - c;
  const double table[6][3] = {{c, x, 0}, {x, c, 0}, {0, c, x}, {0, x, c}, {x, 0, c}, {c, 0, x}};
  const double* rgb = table[static_cast<int>(k) % 6];
  return {cv::saturate_cast<std::uint8_t>(255.0 * (rgb[2] + m)),
          cv::saturate_cast<std::uint8_t>(255.0 * (rgb[1] + m)),
          cv::saturate_cast<std::uint8_t>(255.0 * (rgb[0] + m))};
}

}  // namespace orchard::test
