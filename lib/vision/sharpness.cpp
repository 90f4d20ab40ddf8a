// SPDX-License-Identifier: BSD-3-Clause
#include "vision/sharpness.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace orchard::vision {
namespace {

// physical: the filter needs 5 pixels; black and white after JPEG compression; noise of one level.
constexpr int kMinSide_px = 5;
constexpr double kBlack = 4.0, kWhite = 251.0;
constexpr double kNoise_grey = 1.0;

/// Brightness of each pixel with the weights of ITU-R BT.601.
std::vector<double> brightness(const PixelBlock& block) {
  std::vector<double> grey(block.bgr.size() / 3);
  for (std::size_t i = 0; i < grey.size(); ++i) {
    grey[i] =
        0.114 * block.bgr[3 * i] + 0.587 * block.bgr[3 * i + 1] + 0.299 * block.bgr[3 * i + 2];
  }
  return grey;
}

}  // namespace

Sharpness sharpness(const PixelBlock& block) {
  const int width = block.area.width_px, height = block.area.height_px;
  Sharpness result;
  if (width < kMinSide_px || height < kMinSide_px) return result;
  const std::vector<double> grey = brightness(block);
  const auto at = [&](int x, int y) {
    return grey[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                static_cast<std::size_t>(x)];
  };
  // Binomial smoothing along rows and columns suppresses pixel noise.
  const auto smooth = [&](int x, int y) {
    const auto row = [&](int v) {
      return 0.25 * at(x - 1, v) + 0.5 * at(x, v) + 0.25 * at(x + 1, v);
    };
    return 0.25 * row(y - 1) + 0.5 * row(y) + 0.25 * row(y + 1);
  };
  double sum = 0.0, sum_squares = 0.0, energy = 0.0;
  int num = 0;
  for (int y = 1; y + 2 < height; ++y) {
    for (int x = 1; x + 2 < width; ++x) {
      const double here = smooth(x, y);
      const double dx = smooth(x + 1, y) - here, dy = smooth(x, y + 1) - here;
      sum += here;
      sum_squares += here * here;
      energy += dx * dx + dy * dy;
      ++num;
    }
  }
  const double mean = sum / num;
  const double variance = std::max(0.0, sum_squares / num - mean * mean);
  const double above_noise = std::max(0.0, energy / num - kNoise_grey * kNoise_grey);
  result.detail_per_px = std::sqrt(above_noise / (variance + kNoise_grey * kNoise_grey));
  const auto num_clipped = std::count_if(
      grey.begin(), grey.end(), [](double value) { return value <= kBlack || value >= kWhite; });
  result.clipped_fraction = static_cast<double>(num_clipped) / static_cast<double>(grey.size());
  return result;
}

}  // namespace orchard::vision
