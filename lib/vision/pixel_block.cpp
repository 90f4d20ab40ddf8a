// SPDX-License-Identifier: BSD-3-Clause
#include "vision/pixel_block.hpp"

#include <turbojpeg.h>
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace orchard::vision {
namespace {

/// derived: larger values could not be added as integers.
constexpr double kMaxSize_px = 1e5;

}  // namespace

std::optional<PixelRect> window_around(double x_px, double y_px, double depth_m, double width_m,
                                       double height_m, double focal_x_px, double focal_y_px,
                                       const PixelRect& picture, int min_size_px) {
  const double width_px = focal_x_px * width_m / depth_m;
  const double height_px = focal_y_px * height_m / depth_m;
  if (!(depth_m > 0.0) || !(width_px >= min_size_px) || !(height_px >= min_size_px) ||
      width_px > kMaxSize_px || height_px > kMaxSize_px || !(std::abs(x_px) <= kMaxSize_px) ||
      !(std::abs(y_px) <= kMaxSize_px)) {
    return std::nullopt;
  }
  PixelRect whole;
  whole.width_px = static_cast<int>(std::lround(width_px));
  whole.height_px = static_cast<int>(std::lround(height_px));
  whole.x_px = static_cast<int>(std::lround(x_px - 0.5 * (whole.width_px - 1)));
  whole.y_px = static_cast<int>(std::lround(y_px - 0.5 * (whole.height_px - 1)));
  const PixelRect clipped = intersection(whole, picture);
  if (clipped.width_px < min_size_px || clipped.height_px < min_size_px ||
      2.0 * clipped.width_px * clipped.height_px < 1.0 * whole.width_px * whole.height_px) {
    return std::nullopt;
  }
  return clipped;
}

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

/// Binomial smoothing of three values `step` apart, except at the ends of the array.
std::vector<double> smoothed(const std::vector<double>& values, std::size_t step) {
  std::vector<double> smooth(values.size());
  for (std::size_t i = step; i + step < values.size(); ++i) {
    smooth[i] = 0.25 * values[i - step] + 0.5 * values[i] + 0.25 * values[i + step];
  }
  return smooth;
}

}  // namespace

Sharpness sharpness(const PixelBlock& block) {
  const int width = block.area.width_px, height = block.area.height_px;
  Sharpness result;
  if (width < kMinSide_px || height < kMinSide_px) return result;
  const std::vector<double> grey = brightness(block);
  // Smoothing along rows and columns suppresses pixel noise.
  const auto columns = static_cast<std::size_t>(width);
  const std::vector<double> smooth = smoothed(smoothed(grey, 1), columns);
  double sum = 0.0, sum_squares = 0.0, energy = 0.0;
  int num = 0;
  for (int y = 1; y + 2 < height; ++y) {
    for (int x = 1; x + 2 < width; ++x) {
      const double* pixel = &smooth[static_cast<std::size_t>(y) * columns + x];
      const double here = *pixel, dx = pixel[1] - here, dy = pixel[width] - here;
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

std::vector<std::uint8_t> write_jpeg(const PixelBlock& block, int quality,
                                     JpegTransform transform) {
  if (block.area.empty()) return {};
  const std::unique_ptr<void, int (*)(void*)> encoder(tjInitCompress(), tjDestroy);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const int result =
      encoder ? tjCompress2(encoder.get(), block.bgr.data(), block.area.width_px, 0,
                            block.area.height_px, TJPF_BGR, &buffer, &size, TJSAMP_420, quality,
                            transform == JpegTransform::kExact ? TJFLAG_ACCURATEDCT : 0)
              : -1;
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(buffer, tjFree);
  if (result != 0) return {};
  return std::vector<std::uint8_t>(buffer, buffer + size);
}

PixelBlock shrunk(const PixelBlock& block, int divisor) {
  if (divisor <= 1) return block;
  PixelBlock small;
  small.area = block.area;
  small.area.width_px /= divisor;
  small.area.height_px /= divisor;
  const auto columns = static_cast<std::size_t>(block.area.width_px);
  const auto step = static_cast<std::size_t>(divisor);
  const auto num = static_cast<unsigned>(step * step);
  const auto width = static_cast<std::size_t>(small.area.width_px);
  const auto height = static_cast<std::size_t>(small.area.height_px);
  small.bgr.reserve(3 * width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        unsigned sum = num / 2;
        for (std::size_t dy = 0; dy < step; ++dy) {
          for (std::size_t dx = 0; dx < step; ++dx) {
            sum += block.bgr[3 * ((y * step + dy) * columns + x * step + dx) + c];
          }
        }
        small.bgr.push_back(static_cast<std::uint8_t>(sum / num));
      }
    }
  }
  return small;
}

}  // namespace orchard::vision
