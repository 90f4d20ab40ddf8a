// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::io {

/// Formats a name as a CSV field: quoted if it contains a separator or quotes (RFC 4180).
inline std::string csv_field(const std::string& text) {
  if (text.find_first_of("\",;") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

}  // namespace orchard::io
