// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::bus {

/// Receives SIGINT, SIGTERM, SIGHUP and SIGPIPE through a file descriptor, so that they arrive only
/// in the event loop. Construct it before the bus: LCM's thread inherits the blocked signals.
class StopSignal {
 public:
  /// Throws std::system_error.
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  int fileno() const { return fileno_; }

  /// Whether a stop was requested; stays true.
  bool raised();

  /// Waits until `other` is readable, a stop is requested, or the timeout ends (negative: none).
  /// Returns whether `other` is readable.
  bool wait(int other, int timeout_ms);

 private:
  int fileno_ = -1;
  bool raised_ = false;
};

}  // namespace orchard::bus
