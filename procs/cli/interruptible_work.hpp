// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include "io/progress_bar.hpp"

namespace orchard::cli {

/// Thrown at Ctrl-C or SIGTERM during a long operation. Partly written files have been removed.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted; no output was written") {}
};

/// Shows a progress bar on a terminal and makes a long operation interruptible: while an object
/// exists, SIGINT and SIGTERM make its next update() throw, so that the caller can clean up, and a
/// reader of the output that has had enough (`| head`) ends nothing. A second Ctrl-C kills at once.
class InterruptibleWork {
 public:
  explicit InterruptibleWork(std::string label, bool show_progress = true);
  ~InterruptibleWork();
  InterruptibleWork(const InterruptibleWork&) = delete;
  InterruptibleWork& operator=(const InterruptibleWork&) = delete;

  /// Throws Interrupted.
  void update(std::uint64_t done, std::uint64_t total);

  /// Removes the bar.
  void finish() { bar_.finish(); }

 private:
  io::ProgressBar bar_;
  void (*on_broken_pipe_)(int);  ///< as before
};

}  // namespace orchard::cli
