// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// The numbers of a list like "3,7,9-20", rising and each once; `what` is the option for messages.
/// Throws io::FileError for anything else, and for more than 10000 numbers.
std::vector<int> parse_number_list(const std::string& text, const std::string& what);

}  // namespace orchard::cli
