// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdio>
#include <string>

namespace orchard::bench {

/// One row of the table that tests/benchmark/benchmark.sh prints. Returns whether the target was
/// met.
inline bool print_result(const std::string& what, const std::string& measured,
                         const std::string& target, bool met) {
  std::printf("result | %s | %s | %s | %s\n", what.c_str(), measured.c_str(), target.c_str(),
              met ? "met" : "MISSED");
  std::fflush(stdout);
  return met;
}

/// A row without a target, for comparison.
inline void print_figure(const std::string& what, const std::string& measured) {
  std::printf("result | %s | %s | (for comparison) | -\n", what.c_str(), measured.c_str());
  std::fflush(stdout);
}

}  // namespace orchard::bench
