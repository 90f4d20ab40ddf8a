// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "bus/messages/message.hpp"

namespace orchard::bus {

/// A sensor, or something that plays one: the messages of a driver in order of utime. The host
/// paces and publishes them.
class Source {
 public:
  virtual ~Source() = default;

  /// The next message, or none when there will be no more.
  virtual std::optional<Message> next() = 0;

  /// How long all messages together last, by their own time [s]; none when that is not known.
  virtual std::optional<double> duration_s() const { return std::nullopt; }
};

}  // namespace orchard::bus
