// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "vision/image.hpp"

namespace orchard::view {

/// Converts a raw image (BGR8 or GRAY8 with the number of bytes of its size) to a 24-bit Windows
/// bitmap, which browsers display. Empty for any other image.
std::string bitmap(const vision::Image& image);

}  // namespace orchard::view
