// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/driver/driver.hpp"
#include "bus/driver/port.hpp"
#include "device/protocol.hpp"
#include "io/recording/raw_bytes.hpp"

namespace orchard::bus {

/// Assigns sequence numbers to a driver's messages: seq from 0, +1 per message of a channel.
class MessageNumbers {
 public:
  /// Converts a measurement to a numbered message.
  Message number(device::Measurement measurement);

 private:
  std::array<std::int32_t, kNumChannels> next_seq_{};
};

/// Driver of a device with a byte protocol: runs the protocol on a port. It reconnects after an
/// unplugged cable, a reboot or silence of the device.
class StreamDriver : public Driver {
 public:
  /// `raw_path`: file to which the raw bytes are recorded; empty: none. Throws io::FileError.
  StreamDriver(std::unique_ptr<device::Protocol> protocol, PortAddress address,
               const std::string& raw_path = {});

  std::vector<pollfd> files() override;
  Clock::time_point deadline() override;
  void step(const Outbox& send) override;
  DriverCondition condition() const override;

 private:
  void record(io::RawKind kind, std::string bytes, std::int64_t host_utime);
  void note_clock_step(std::int64_t host_utime);
  void expire_when_due(std::int64_t host_utime);

  std::unique_ptr<device::Protocol> protocol_;
  Port port_;
  HostClock clock_;
  MessageNumbers numbers_;
  std::unique_ptr<io::RawBytesWriter> raw_;
  std::string raw_problem_;
};

}  // namespace orchard::bus
