// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "bus/messages/message.hpp"

namespace orchard::bus {

/// A sensor or an emulation of one: provides messages in order of utime. The host paces and
/// publishes them.
class Source {
 public:
  virtual ~Source() = default;

  /// Returns the next message, or none at the end.
  virtual std::optional<Message> next() = 0;

  /// Duration of all messages by their own time [s]; none when unknown.
  virtual std::optional<double> duration_s() const { return std::nullopt; }
};

}  // namespace orchard::bus
