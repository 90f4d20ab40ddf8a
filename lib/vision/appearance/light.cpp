// SPDX-License-Identifier: BSD-3-Clause
#include "vision/appearance/light.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "vision/block_view.hpp"

namespace orchard::vision {
namespace {

// Values outside these limits do not scale with the light.
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
