// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// Makes the parent folder of a file if it is missing. Does nothing for an empty path. Throws
/// io::FileError.
void make_parent_folder(const std::string& file_path);

/// The candidate nearest to a misspelt word, or empty when none is near. Distance: the number of
/// insertions, deletions, substitutions and swaps of neighbours, at most a third of the word's
/// length plus one.
std::string nearest_word(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace orchard::cli
