// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::io {

/// A number with that many decimals, whatever the locale; never "-0.000".
std::string fixed_text(double value, int num_decimals);

}  // namespace orchard::io
