// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard {

/// Formats a number with that many decimals, rounded from its exact value, independent of the
/// locale; never "-0.000".
std::string fixed_text(double value, int num_decimals);

/// The shortest decimal text that reads back as the same double.
std::string shortest_text(double value);

}  // namespace orchard
