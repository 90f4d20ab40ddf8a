// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/windows/disturbance.hpp"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "vision/exposure.hpp"

namespace orchard::evaluation {

vision::PixelBlock disturbed(const vision::PixelBlock& pixels, const Disturbance& disturbance) {
  vision::PixelBlock result = pixels;
  if (disturbance.blur_px > 0.0) {
    cv::Mat view(result.area.height_px, result.area.width_px, CV_8UC3, result.bgr.data());
    cv::GaussianBlur(view, view, {0, 0}, disturbance.blur_px);
  }
  const double gain = std::exp2(disturbance.exposure_ev);
  const std::array<std::array<std::uint8_t, 256>, 3> curves{
      vision::exposure_curve(gain * disturbance.blue_gain), vision::exposure_curve(gain),
      vision::exposure_curve(gain * disturbance.red_gain)};
  for (std::size_t i = 0; i < result.bgr.size(); ++i) result.bgr[i] = curves[i % 3][result.bgr[i]];
  return result;
}

}  // namespace orchard::evaluation
