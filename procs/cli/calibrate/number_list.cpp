// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/number_list.hpp"

#include <charconv>
#include <set>
#include <sstream>

#include "io/file_error.hpp"

namespace orchard::cli {
namespace {

constexpr std::size_t kMaxNumbers = 10000;

/// Parses a text that is entirely a number; -1 otherwise.
int number_of(const std::string& text) {
  int number = -1;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number);
  return result.ec == std::errc() && result.ptr == end && !text.empty() ? number : -1;
}

}  // namespace

std::vector<int> parse_number_list(const std::string& text, const std::string& what) {
  const auto refuse = [&](const std::string& part) {
    throw io::FileError(what + " " + text + ": \"" + part +
                        "\" is neither a number nor a range such as 9-20");
  };
  std::set<int> numbers;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    const int first = number_of(part.substr(0, dash));
    const int last = dash == std::string::npos ? first : number_of(part.substr(dash + 1));
    if (first < 0 || last < first) refuse(part);
    if (static_cast<std::size_t>(last - first) >= kMaxNumbers) refuse(part);
    for (int number = first; number <= last; ++number) numbers.insert(number);
    if (numbers.size() > kMaxNumbers) refuse(part);
  }
  if (numbers.empty()) refuse(text);
  return {numbers.begin(), numbers.end()};
}

}  // namespace orchard::cli
