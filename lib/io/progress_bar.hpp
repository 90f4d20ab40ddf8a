// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace orchard::io {

/// A bar on standard error while something long runs: on a terminal only, nothing in a pipe.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label, bool enabled = true);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::uint64_t done, std::uint64_t total);

  /// Removes the bar, so that what is printed next starts on a clean line.
  void finish();

 private:
  std::string label_;
  bool enabled_;
  int percent_ = -1;
};

}  // namespace orchard::io
