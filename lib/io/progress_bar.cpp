// SPDX-License-Identifier: BSD-3-Clause
#include "io/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace orchard::io {
namespace {

/// Minimum elapsed time for an estimate of the remaining time.
constexpr double kEarly_s = 2.0;

}  // namespace

std::string waiting_text(double seconds) {
  const auto whole = static_cast<long long>(std::ceil(std::max(0.0, seconds)));
  if (whole < 60) return std::to_string(whole) + " s";
  const long long minutes = (whole + 59) / 60;
  if (minutes < 60) return std::to_string(minutes) + " min";
  return std::to_string(minutes / 60) + " h " + std::to_string(minutes % 60) + " min";
}

ProgressBar::ProgressBar(std::string label, bool enabled)
    : label_(std::move(label)), enabled_(enabled && isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() { finish(); }

void ProgressBar::update(std::uint64_t done, std::uint64_t total) {
  if (!enabled_) return;
  const Clock::time_point now = Clock::now();
  if (total == 0) {
    if (percent_ == 0 && now - drawn_ < std::chrono::milliseconds(200)) return;
    percent_ = 0;
    drawn_ = now;
    std::fprintf(stderr, "\r%s: %llu\033[K", label_.c_str(), static_cast<unsigned long long>(done));
    std::fflush(stderr);
    return;
  }
  const int percent = static_cast<int>(100.0 * static_cast<double>(std::min(done, total)) /
                                       static_cast<double>(total));
  if (percent == percent_ && now - drawn_ < std::chrono::seconds(1)) return;
  percent_ = percent;
  drawn_ = now;
  const double passed_s = std::chrono::duration<double>(now - start_).count();
  std::string left;
  if (done > 0 && passed_s > kEarly_s) {
    const double fraction = static_cast<double>(done) / static_cast<double>(total);
    left = ", " + waiting_text(passed_s * (1.0 / fraction - 1.0)) + " left";
  }
  constexpr int kCells = 30;
  std::string cells(static_cast<std::size_t>(percent * kCells / 100), '#');
  cells.resize(kCells, '.');
  std::fprintf(stderr, "\r%s [%s] %3d %%%s\033[K", label_.c_str(), cells.c_str(), percent,
               left.c_str());
  std::fflush(stderr);
}

void ProgressBar::finish() {
  if (!enabled_ || percent_ < 0) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  percent_ = -1;
}

}  // namespace orchard::io
