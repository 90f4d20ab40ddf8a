// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "vision/pixel_block.hpp"
#include "vision/vision_config.hpp"

namespace orchard::vision {

inline constexpr int kNumHues = 180;  ///< OpenCV's 8-bit hue: steps of 2 degrees
inline constexpr double kHueStep_deg = 2.0;

/// How often each hue occurs among a window's coloured pixels (saturation and value not below
/// their floors), and how many pixels the window has.
struct HueHistogram {
  std::array<int, kNumHues> counts{};  ///< index = hue / kHueStep_deg
  int num_coloured = 0;
  int num_pixels = 0;
};

/// The hues of a window. Throws std::invalid_argument when it does not lie inside the block.
HueHistogram hue_histogram(const PixelBlock& pixels, const PixelRect& window,
                           const ColourConfig& config);

/// Most dominant hue [deg]: mean hue of the fullest of config.hue_bins bins (the lower of equals);
/// 0 without coloured pixels. Source: Shalal et al. 2013, section 4.2.
double dominant_hue_deg(const HueHistogram& histogram, int hue_bins);

/// Whether a hue lies in the circular interval from min to max, ends included; min > max wraps
/// through red.
bool hue_in_range(double hue_deg, double hue_min_deg, double hue_max_deg);

/// What the colour of a window says of a trunk.
struct ColourEvidence {
  double dominant_hue_deg = 0.0;
  bool passed = false;  ///< the dominant hue is a trunk's: only then edges are looked at
  double roc = 0.0;     ///< roc_colour, 0 unless passed
};

/// The rule of Shalal et al. 2013, figure 8: the dominant hue must be a trunk's; roc_colour is the
/// fraction of the window's pixels that are coloured and have a trunk's hue.
ColourEvidence colour_confidence(const HueHistogram& histogram, const ColourConfig& config);

}  // namespace orchard::vision
