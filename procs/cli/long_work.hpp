// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "io/progress_bar.hpp"

namespace orchard::cli {

/// Ctrl-C or SIGTERM while something long ran. What was being written has been taken back.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted; nothing was written") {}
};

/// A progress bar on a terminal, and an end of the work at Ctrl-C that cleans up: while one lives,
/// SIGINT and SIGTERM make its next update() throw. A second Ctrl-C kills at once.
class LongWork {
 public:
  explicit LongWork(std::string label, bool show_progress = true);
  ~LongWork();
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;

  /// Throws Interrupted.
  void update(std::uint64_t done, std::uint64_t total);

  /// Removes the bar.
  void finish() { bar_.finish(); }

 private:
  io::ProgressBar bar_;
};

}  // namespace orchard::cli
