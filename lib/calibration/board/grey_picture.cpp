// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/board/grey_picture.hpp"

#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/decode.hpp"

namespace orchard::calibration {

GreyPicture grey_of(const vision::PixelBlock& pixels) {
  GreyPicture picture{pixels.area.width_px, pixels.area.height_px, {}};
  if (pixels.area.empty()) return {};
  picture.grey.resize(static_cast<std::size_t>(picture.width_px) *
                      static_cast<std::size_t>(picture.height_px));
  const cv::Mat bgr(picture.height_px, picture.width_px, CV_8UC3,
                    const_cast<std::uint8_t*>(pixels.bgr.data()));
  cv::Mat grey(picture.height_px, picture.width_px, CV_8UC1, picture.grey.data());
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  return picture;
}

std::optional<GreyPicture> grey_of(const vision::Image& image) {
  if (image.width_px <= 0 || image.height_px <= 0) return std::nullopt;
  if (image.encoding == vision::Encoding::kGray8) {
    if (image.data.size() !=
        static_cast<std::size_t>(image.width_px) * static_cast<std::size_t>(image.height_px)) {
      return std::nullopt;
    }
    return GreyPicture{image.width_px, image.height_px, image.data};
  }
  const auto pixels = vision::decode(image, {0, 0, image.width_px, image.height_px});
  if (!pixels) return std::nullopt;
  return grey_of(*pixels);
}

}  // namespace orchard::calibration
