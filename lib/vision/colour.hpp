// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "vision/pixel_block.hpp"
#include "vision/vision_config.hpp"

namespace orchard::vision {

/// physical: OpenCV's 8-bit hue.
inline constexpr int kNumHues = 180;
inline constexpr double kHueStep_deg = 2.0;

/// Histogram of the hues of a window's coloured pixels: those with saturation and value not below
/// the tuned minimum.
struct HueHistogram {
  std::array<int, kNumHues> counts{};  ///< index = hue / kHueStep_deg
  int num_coloured = 0;
  int num_pixels = 0;  ///< all pixels of the window
};

/// Computes the hue histogram of a window. Throws std::invalid_argument when the window does not
/// lie inside the block.
HueHistogram hue_histogram(const PixelBlock& pixels, const PixelRect& window);

/// Dominant hue [deg]: mean hue of the fullest of `hue_bins` bins (of equal bins the lower one); 0
/// without coloured pixels. Source: Shalal et al. 2013, section 4.2.
double dominant_hue_deg(const HueHistogram& histogram, int hue_bins);

/// Whether a hue lies in the circular interval from min to max, ends included. min > max wraps
/// through red.
bool hue_in_range(double hue_deg, double hue_min_deg, double hue_max_deg);

/// Result of the colour test of a window.
struct ColourEvidence {
  double dominant_hue_deg = 0.0;
  bool passed = false;  ///< the dominant hue is a trunk's; otherwise edges are not examined
  double roc = 0.0;     ///< roc_colour, 0 unless passed
};

/// Tests the colour of a window by the rule of Shalal et al. 2013, figure 8: the dominant hue must
/// be in the trunk's interval; roc_colour is the fraction of the window's pixels that are coloured
/// and have a hue in the interval.
ColourEvidence colour_confidence(const HueHistogram& histogram, const ColourConfig& config);

}  // namespace orchard::vision
