// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "bus/driver/source.hpp"
#include "bus/driver/stream_driver.hpp"
#include "device/protocol.hpp"
#include "io/recording/raw_bytes.hpp"

namespace orchard::bus {

/// Replays a recording of a device's raw bytes through the same protocol as live, giving the same
/// measurements with the same stamps.
class RawSource : public Source {
 public:
  /// Throws io::FileError.
  RawSource(std::unique_ptr<device::Protocol> protocol, const std::string& raw_path);

  std::optional<Message> next() override;

 private:
  bool feed();

  std::unique_ptr<device::Protocol> protocol_;
  io::RawBytesReader reader_;
  std::deque<device::Measurement> waiting_;
  MessageNumbers numbers_;
};

}  // namespace orchard::bus
