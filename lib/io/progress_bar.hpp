// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace orchard::io {

/// Shows a progress bar with the remaining time on standard error, on a terminal only.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label, bool enabled = true);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Updates the bar. If `total` is 0 (unknown), `done` is shown as a number.
  void update(std::uint64_t done, std::uint64_t total);

  /// Removes the bar, so that later output starts on a clean line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_;
  bool enabled_;
  int percent_ = -1;
  Clock::time_point start_ = Clock::now();
  Clock::time_point drawn_;
};

/// Formats a waiting time [s], rounded up: "40 s", "3 min" or "2 h 5 min".
std::string waiting_text(double seconds);

}  // namespace orchard::io
