// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <string>
#include <type_traits>
#include <vector>

/// What a program of the experiments prints: one JSON object a line, which trials.py makes figures
/// of.
namespace orchard::trials {

struct JsonField {
  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  JsonField(const char* name, Number value) : key(name), text(of(static_cast<double>(value))) {}
  /// Text without quotes, backslashes and control characters.
  JsonField(const char* name, const std::string& value) : key(name), text('"' + value + '"') {}
  JsonField(const char* name, const std::vector<double>& values) : key(name), text("[") {
    for (const double value : values) text += (text.size() > 1 ? ", " : "") + of(value);
    text += ']';
  }
  static std::string of(double value) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.9g", value);
    return std::isfinite(value) ? digits : "null";
  }
  std::string key, text;
};

inline void print_json(std::initializer_list<JsonField> fields) {
  std::string line;
  for (const JsonField& f : fields)
    line += (line.empty() ? "{\"" : ", \"") + f.key + "\": " + f.text;
  std::printf("%s}\n", line.c_str());
  std::fflush(stdout);
}

}  // namespace orchard::trials
