// SPDX-License-Identifier: BSD-3-Clause
#include "io/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace orchard::io {

ProgressBar::ProgressBar(std::string label, bool enabled)
    : label_(std::move(label)), enabled_(enabled && isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() { finish(); }

void ProgressBar::update(std::uint64_t done, std::uint64_t total) {
  if (!enabled_ || total == 0) return;
  const int percent = static_cast<int>(100.0 * static_cast<double>(std::min(done, total)) /
                                       static_cast<double>(total));
  if (percent == percent_) return;
  percent_ = percent;
  constexpr int kCells = 30;
  std::string cells(static_cast<std::size_t>(percent * kCells / 100), '#');
  cells.resize(kCells, '.');
  std::fprintf(stderr, "\r%s [%s] %3d %%", label_.c_str(), cells.c_str(), percent);
  std::fflush(stderr);
}

void ProgressBar::finish() {
  if (!enabled_ || percent_ < 0) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  percent_ = -1;
}

}  // namespace orchard::io
