// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/colour.hpp"

namespace orchard::calibration {

/// A circular interval of hues; min_deg > max_deg wraps through red.
struct HueInterval {
  double min_deg = 0.0;
  double max_deg = 0.0;
  double width_deg = 0.0;
};

/// Adds a histogram's counts to another.
void add(const vision::HueHistogram& hues, vision::HueHistogram& sum);

/// The shortest circular interval that excludes at most the fraction `tail` of the coloured pixels
/// at each end (counted from the hue opposite their mean), widened by a margin on both sides.
/// Throws std::invalid_argument without coloured pixels.
HueInterval hue_interval(const vision::HueHistogram& hues, double tail, double margin_deg);

}  // namespace orchard::calibration
