// SPDX-License-Identifier: BSD-3-Clause
#include "vision/colour.hpp"

#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "vision/block_view.hpp"

namespace orchard::vision {

HueHistogram hue_histogram(const PixelBlock& pixels, const PixelRect& window) {
  cv::Mat hsv;
  cv::cvtColor(view_of(pixels, window), hsv, cv::COLOR_BGR2HSV);
  const double saturation_min = 255.0 * tuning::kSaturationMin;
  const double value_min = 255.0 * tuning::kValueMin;
  HueHistogram histogram;
  histogram.num_pixels = window.width_px * window.height_px;
  for (int y = 0; y < hsv.rows; ++y) {
    const auto* row = hsv.ptr<std::uint8_t>(y);
    for (int x = 0; x < hsv.cols; ++x, row += 3) {
      if (row[1] < saturation_min || row[2] < value_min) continue;
      ++histogram.counts[row[0] % kNumHues];
      ++histogram.num_coloured;
    }
  }
  return histogram;
}

double dominant_hue_deg(const HueHistogram& histogram, int hue_bins) {
  if (hue_bins <= 0 || hue_bins > kNumHues) {
    throw std::invalid_argument("hue_bins must be in [1, 180]");
  }
  std::vector<int> counts(static_cast<std::size_t>(hue_bins));
  std::vector<double> sums(counts.size());
  for (int hue = 0; hue < kNumHues; ++hue) {
    const auto bin = static_cast<std::size_t>(hue * hue_bins / kNumHues);
    counts[bin] += histogram.counts[static_cast<std::size_t>(hue)];
    sums[bin] += hue * kHueStep_deg * histogram.counts[static_cast<std::size_t>(hue)];
  }
  std::size_t best = 0;
  for (std::size_t bin = 1; bin < counts.size(); ++bin) {
    if (counts[bin] > counts[best]) best = bin;
  }
  return counts[best] > 0 ? sums[best] / counts[best] : 0.0;
}

bool hue_in_range(double hue_deg, double hue_min_deg, double hue_max_deg) {
  if (hue_min_deg <= hue_max_deg) return hue_deg >= hue_min_deg && hue_deg <= hue_max_deg;
  return hue_deg >= hue_min_deg || hue_deg <= hue_max_deg;
}

ColourEvidence colour_confidence(const HueHistogram& histogram, const ColourConfig& config) {
  ColourEvidence evidence;
  if (histogram.num_coloured == 0) return evidence;
  evidence.dominant_hue_deg = dominant_hue_deg(histogram, ColourConfig::kHueBins);
  evidence.passed = hue_in_range(evidence.dominant_hue_deg, config.hue_min_deg, config.hue_max_deg);
  if (!evidence.passed) return evidence;
  int num_inside = 0;
  for (int hue = 0; hue < kNumHues; ++hue) {
    if (hue_in_range(hue * kHueStep_deg, config.hue_min_deg, config.hue_max_deg)) {
      num_inside += histogram.counts[static_cast<std::size_t>(hue)];
    }
  }
  evidence.roc = static_cast<double>(num_inside) / histogram.num_pixels;
  return evidence;
}

}  // namespace orchard::vision
