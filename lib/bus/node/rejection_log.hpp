// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "bus/messages/codec.hpp"

namespace orchard::bus {

/// Logs rejected messages, at most one line per channel and reason in five seconds, so that a flood
/// of bad datagrams does not flood the log.
class RejectionLog {
 public:
  void note(Channel channel, const Rejection& rejection);

 private:
  struct Entry {
    std::chrono::steady_clock::time_point last{};
    std::int64_t num_silent = 0;
    bool used = false;
  };
  std::array<Entry, kNumChannels * kNumReasons> entries_;
};

}  // namespace orchard::bus
