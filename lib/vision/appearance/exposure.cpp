// SPDX-License-Identifier: BSD-3-Clause
#include "vision/appearance/exposure.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace orchard::vision {
namespace {

/// Mean grey level below which a picture is nearly black.
constexpr double kGreyLevelsMin = 10.0;

double linear_of(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

double srgb_of(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

}  // namespace

std::array<std::uint8_t, 256> exposure_curve(double gain) {
  std::array<std::uint8_t, 256> curve{};
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double light = std::min(1.0, gain * linear_of(static_cast<double>(i) / 255.0));
    curve[i] = static_cast<std::uint8_t>(std::lround(255.0 * srgb_of(light)));
  }
  return curve;
}

void normalise_exposure(PixelBlock& pixels) {
  std::array<std::size_t, 256> counts{};
  for (const std::uint8_t value : pixels.bgr) ++counts[value];
  double light = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    light += static_cast<double>(counts[i]) * linear_of(static_cast<double>(i) / 255.0);
  }
  light /= static_cast<double>(std::max<std::size_t>(1, pixels.bgr.size()));
  if (light >= kMeteredLight || light < kGreyLevelsMin * linear_of(1.0 / 255.0)) return;
  const auto curve = exposure_curve(kMeteredLight / light);
  for (std::uint8_t& value : pixels.bgr) value = curve[value];
}

PixelBlock exposed(const PixelBlock& pixels, double exposure_ev) {
  PixelBlock result = pixels;
  const auto curve = exposure_curve(std::exp2(exposure_ev));
  for (std::uint8_t& value : result.bgr) value = curve[value];
  return result;
}

std::vector<PixelBlock> learnt_exposures(PixelBlock pixels) {
  normalise_exposure(pixels);
  std::vector<PixelBlock> result;
  for (const double exposure_ev : kLearntExposures_ev) {
    result.push_back(exposed(pixels, exposure_ev));
  }
  return result;
}

}  // namespace orchard::vision
