// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <ctime>
#include <string>
#include <vector>

namespace orchard::cli {

/// Measures the cost of a long replay: processor time per scan and memory, per thousand scans.
/// Printed only; it reaches no file.
class ScanTimer {
 public:
  /// Counts one processed scan.
  void count();

  /// One line per thousand: `timing: scans 1-1000: 0.912 ms a scan, 43.1 MiB at most`; and one of
  /// the most memory up to now, the files that were written included.
  std::string text() const;

 private:
  struct Stretch {
    std::int64_t first, last;
    double ms_per_scan;
    double peak_mib;
  };
  std::int64_t num_scans_ = 0;
  std::clock_t begin_ = std::clock();
  std::vector<Stretch> stretches_;
};

}  // namespace orchard::cli
