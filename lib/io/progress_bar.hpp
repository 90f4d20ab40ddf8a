// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace orchard::io {

/// A bar with the time left on standard error while something long runs: on a terminal only,
/// nothing in a pipe.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label, bool enabled = true);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// A total of 0 is not known: `done` is shown as it is.
  void update(std::uint64_t done, std::uint64_t total);

  /// Removes the bar, so that what is printed next starts on a clean line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_;
  bool enabled_;
  int percent_ = -1;
  Clock::time_point start_ = Clock::now();
  Clock::time_point drawn_;
};

/// "40 s", "3 min" or "2 h 5 min", rounded up: what a person wants to know of a time to wait [s].
std::string waiting_text(double seconds);

}  // namespace orchard::io
