// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// Parses a list of numbers such as "3,7,9-20" to unique numbers in ascending order; `what` names
/// the option in messages. Throws io::FileError for anything else, and for more than 10000 numbers.
std::vector<int> parse_number_list(const std::string& text, const std::string& what);

}  // namespace orchard::cli
