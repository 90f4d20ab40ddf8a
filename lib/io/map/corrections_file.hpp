// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/corrections/correction.hpp"

namespace orchard::io {

/// The name of a map folder's corrections: one JSON object per line, in the order in which people
/// made them. Lines are only ever added.
inline constexpr char kCorrectionsFile[] = "corrections.jsonl";

inline constexpr std::size_t kCorrectionTextMax_bytes = 2000;  ///< of a note, a name, a person

struct StoredCorrections {
  std::vector<mapping::Correction> list;
  /// After the last whole line: what a killed program began to write. It is not used.
  std::size_t num_unfinished_bytes = 0;
};

/// What corrections.jsonl of a map folder holds; nothing when there is none. Throws FileError
/// "file:line: what" at the first mistake.
StoredCorrections read_corrections(const std::string& folder);

/// The same of a text; `name` stands for the file.
StoredCorrections parse_corrections(std::string_view text, const std::string& name);

/// A correction as a line of the file, its end included.
std::string correction_line(const mapping::Correction& correction);

/// "2026-05-04T08:00:00Z" of a utime.
std::string utc_text(std::int64_t utime);

/// Whether a text from a person can stand in the file: UTF-8 without control characters, and not
/// too long.
bool is_correction_text(const std::string& text);

/// Adds corrections to a folder's file. `make` is called with all that there are, while nobody else
/// can add any, and returns the new ones; their numbers are given here. So several editors at once
/// lose nothing, and each sees what the others did before its own is judged. Throws FileError, and
/// what `make` throws; nothing is added then. Returns what was added.
std::vector<mapping::Correction> append_corrections(
    const std::string& folder,
    const std::function<std::vector<mapping::Correction>(const std::vector<mapping::Correction>&)>&
        make);

}  // namespace orchard::io
