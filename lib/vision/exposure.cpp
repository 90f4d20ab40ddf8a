// SPDX-License-Identifier: BSD-3-Clause
#include "vision/exposure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "vision/block_view.hpp"
#include "vision/tuning.hpp"

namespace orchard::vision {
namespace {

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
  if (light >= kMeteredLight || light < tuning::kGreyLevelsMin * linear_of(1.0 / 255.0)) return;
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

namespace {

// physical: values outside these limits of an 8-bit pixel do not scale with the light.
constexpr int kDark = 4;
constexpr int kClipped = 250;

}  // namespace

std::optional<WindowLight> window_light(const PixelBlock& pixels, const PixelRect& window) {
  const cv::Mat view = view_of(pixels, window);
  std::array<double, 3> sums{};
  int num_used = 0;
  for (int y = 0; y < view.rows; ++y) {
    const auto* pixel = view.ptr<std::uint8_t>(y);
    for (int x = 0; x < view.cols; ++x, pixel += 3) {
      const auto [low, high] = std::minmax({pixel[0], pixel[1], pixel[2]});
      if (low < kDark || high > kClipped) continue;
      for (std::size_t c = 0; c < 3; ++c) sums[c] += pixel[c];
      ++num_used;
    }
  }
  if (4 * num_used < view.rows * view.cols || num_used == 0) return std::nullopt;
  const double green = std::log(sums[1] / num_used);
  return WindowLight{std::log(sums[0] / num_used) - green, std::log(sums[2] / num_used) - green,
                     green};
}

}  // namespace orchard::vision
