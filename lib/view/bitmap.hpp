// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "vision/image.hpp"

namespace orchard::view {

/// A raw picture (BGR8 or GRAY8, of as many bytes as its size says) as a Windows bitmap of 24 bits,
/// which browsers show; empty for any other.
std::string bitmap(const vision::Image& image);

}  // namespace orchard::view
