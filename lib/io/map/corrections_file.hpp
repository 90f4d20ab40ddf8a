// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/corrections/correction.hpp"

namespace orchard::io {

/// Name of the corrections file in a map folder: one JSON object per line, in order of time. The
/// file is append-only.
inline constexpr char kCorrectionsFile[] = "corrections.jsonl";

inline constexpr std::size_t kCorrectionTextMax_bytes = 2000;  ///< of a note, name or person

struct StoredCorrections {
  std::vector<mapping::Correction> list;
  /// Bytes after the last complete line, left by a killed program. They are ignored.
  std::size_t num_unfinished_bytes = 0;
};

/// What a line of each kind has besides number, time, person and note.
struct CorrectionShape {
  mapping::CorrectionKind kind;
  std::size_t trees_least, trees_most;  ///< landmarks concerned
  std::size_t num_places;
  const char* fields;  ///< other keys, separated by spaces

  bool has(std::string_view key) const;
};
const CorrectionShape& correction_shape(mapping::CorrectionKind kind);

/// Reads corrections.jsonl of a map folder; empty if there is none. Throws FileError "file:line:
/// what" at the first error.
StoredCorrections read_corrections(const std::string& folder);

/// Parses a text instead; `name` replaces the path in messages.
StoredCorrections parse_corrections(std::string_view text, const std::string& name);

/// Formats a correction as a line of the file, including the line end.
std::string correction_line(const mapping::Correction& correction);

/// Formats a utime as "2026-05-04T08:00:00Z".
std::string utc_text(std::int64_t utime);

/// Whether a user's text is valid in the file: UTF-8 without control characters, of limited size.
bool is_correction_text(const std::string& text);

/// Appends corrections to a folder's file under a lock. `make` receives all existing corrections
/// and returns the new ones, which are numbered here. Several editors therefore lose nothing, and
/// each decides with the others' corrections known. Throws FileError and whatever `make` throws;
/// nothing is appended then. Returns the appended corrections.
std::vector<mapping::Correction> append_corrections(
    const std::string& folder,
    const std::function<std::vector<mapping::Correction>(const std::vector<mapping::Correction>&)>&
        make);

}  // namespace orchard::io
