// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace orchard {

/// The candidate nearest to a misspelt word, the first of several; empty if none is nearer than
/// `below`. Distance: the number of insertions, deletions, substitutions and swaps of neighbours.
std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates,
                         std::size_t below = std::string::npos);

}  // namespace orchard
