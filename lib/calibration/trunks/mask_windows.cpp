// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/mask_windows.hpp"

#include "calibration/tuning.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>
#include <stdexcept>

namespace orchard::calibration {
namespace {

// derived: budgets of the sampling.
constexpr int kTries = 50;          // max tries in a row for a window without trunk
constexpr int kRowsPerWindow = 20;  // max tries for a row with a trunk

class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) {  // identical with every standard library
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  }
  int index(int size) {
    return std::min(static_cast<int>((*this)(0.0, static_cast<double>(size))), size - 1);
  }

 private:
  std::mt19937_64 engine_;
};

/// Counts the trunk pixels of any window in constant time.
class TrunkCounts {
 public:
  explicit TrunkCounts(const TrunkMask& mask) {
    const cv::Mat trunk(mask.height_px, mask.width_px, CV_8UC1,
                        const_cast<std::uint8_t*>(mask.trunk.data()));
    cv::integral(cv::min(trunk, 1), sums_, CV_32S);
  }
  std::int64_t in(const vision::PixelRect& w) const {
    const int right = w.x_px + w.width_px, bottom = w.y_px + w.height_px;
    return std::int64_t{at(right, bottom)} - at(w.x_px, bottom) - at(right, w.y_px) +
           at(w.x_px, w.y_px);
  }

 private:
  int at(int x, int y) const { return sums_.at<int>(y, x); }
  cv::Mat sums_;
};

/// Consecutive trunk columns in a row: the first and their number.
struct Run {
  int first_px = 0;
  int width_px = 0;
};

Run widest_run(const TrunkMask& mask, int row) {
  Run widest, run;
  for (int x = 0; x < mask.width_px; ++x) {
    const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(mask.width_px) +
                   static_cast<std::size_t>(x);
    run = mask.trunk[i] == 0 ? Run{x + 1, 0} : Run{run.first_px, run.width_px + 1};
    if (run.width_px > widest.width_px) widest = run;
  }
  return widest;
}

/// Samples a window on the run; none if it would leave the image or contain too little trunk.
std::optional<vision::PixelRect> window_on(const Run& run, int row, const TrunkMask& mask,
                                           const TrunkCounts& counts, Uniform& uniform,
                                           const MaskWindowOptions& options) {
  const double scatter = options.scatter * run.width_px;
  const double centre_px = run.first_px + 0.5 * run.width_px + uniform(-scatter, scatter);
  const double width_px =
      options.width_scale * run.width_px * uniform(1.0 - options.scatter, 1.0 + options.scatter);
  vision::PixelRect window;
  window.width_px = static_cast<int>(std::lround(width_px));
  const double aspect = uniform(options.aspect_min, options.aspect_max);
  window.height_px = static_cast<int>(std::lround(aspect * options.width_scale * run.width_px));
  window.x_px = static_cast<int>(std::lround(centre_px - 0.5 * window.width_px));
  window.y_px = row - window.height_px / 2;
  if (window.empty() || !vision::PixelRect{0, 0, mask.width_px, mask.height_px}.contains(window)) {
    return std::nullopt;
  }
  const double widest = std::min<double>(window.width_px, run.width_px);
  const double fraction = static_cast<double>(counts.in(window)) / (widest * window.height_px);
  return fraction >= tuning::kMinTrunkFraction ? std::optional(window) : std::nullopt;
}

std::optional<vision::PixelRect> window_elsewhere(vision::PixelRect window, const TrunkMask& mask,
                                                  const TrunkCounts& counts, Uniform& uniform) {
  for (int i = 0; i < kTries; ++i) {
    window.x_px = uniform.index(mask.width_px - window.width_px + 1);
    if (counts.in(window) == 0) return window;
  }
  return std::nullopt;
}

}  // namespace

std::int64_t TrunkMask::num_trunk_px() const {
  return std::count_if(trunk.begin(), trunk.end(), [](std::uint8_t t) { return t != 0; });
}

std::vector<LabelledWindow> sample_windows(const TrunkMask& mask,
                                           const MaskWindowOptions& options) {
  if (mask.trunk.size() !=
      static_cast<std::size_t>(mask.width_px) * static_cast<std::size_t>(mask.height_px)) {
    throw std::invalid_argument("the mask differs from the picture in size");
  }
  std::vector<int> rows;
  std::vector<Run> runs(static_cast<std::size_t>(mask.height_px));
  for (int row = 0; row < mask.height_px; ++row) {
    runs[static_cast<std::size_t>(row)] = widest_run(mask, row);
    if (runs[static_cast<std::size_t>(row)].width_px >= options.min_width_px) rows.push_back(row);
  }
  std::vector<LabelledWindow> windows;
  if (rows.empty()) return windows;
  const TrunkCounts counts(mask);
  Uniform uniform(options.seed);
  int found = 0;
  for (int i = 0; i < kRowsPerWindow * options.per_class && found < options.per_class; ++i) {
    const int row = rows[static_cast<std::size_t>(uniform.index(static_cast<int>(rows.size())))];
    const Run& run = runs[static_cast<std::size_t>(row)];
    const auto on = window_on(run, row, mask, counts, uniform, options);
    if (!on) continue;
    const auto elsewhere = window_elsewhere(*on, mask, counts, uniform);
    if (!elsewhere) continue;
    windows.push_back({*on, true});
    windows.push_back({*elsewhere, false});
    ++found;
  }
  return windows;
}

}  // namespace orchard::calibration
