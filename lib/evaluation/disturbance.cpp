// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/disturbance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace orchard::evaluation {
namespace {

double linear_of(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double srgb_of(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

using Curve = std::array<std::uint8_t, 256>;

Curve curve_of(double gain) {
  Curve curve;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double light = std::min(1.0, gain * linear_of(static_cast<double>(i) / 255.0));
    curve[i] = static_cast<std::uint8_t>(std::lround(255.0 * srgb_of(light)));
  }
  return curve;
}

}  // namespace

vision::PixelBlock disturbed(const vision::PixelBlock& pixels, const Disturbance& disturbance) {
  vision::PixelBlock result = pixels;
  if (disturbance.blur_px > 0.0) {
    cv::Mat view(result.area.height_px, result.area.width_px, CV_8UC3, result.bgr.data());
    cv::GaussianBlur(view, view, {0, 0}, disturbance.blur_px);
  }
  const double gain = std::exp2(disturbance.exposure_ev);
  const std::array<Curve, 3> curves{curve_of(gain * disturbance.blue_gain), curve_of(gain),
                                    curve_of(gain * disturbance.red_gain)};
  for (std::size_t i = 0; i < result.bgr.size(); ++i) result.bgr[i] = curves[i % 3][result.bgr[i]];
  return result;
}

}  // namespace orchard::evaluation
