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

/// A recording of a device's raw bytes, read through the protocol that read them live: the same
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
