// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstdlib>
#include <map>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "bus/messages/codec.hpp"
#include "device/protocol.hpp"

namespace orchard::fuzz {

/// Hands bytes to a protocol in pieces whose sizes follow from `pieces`, and asks and expires in
/// between. What it measures passes the guard of the bus and comes with rising stamps per channel.
inline void feed(device::Protocol& protocol, std::string_view bytes, std::uint8_t pieces) {
  std::int64_t host_utime = 1'700'000'000'000'000;
  std::map<bus::Channel, std::int64_t> last_utime;
  protocol.connected(host_utime);
  for (std::size_t i = 0; !bytes.empty(); ++i) {
    const std::size_t size = 1 + (pieces * (i + 7)) % 61;
    host_utime += 3000;
    protocol.receive(bytes.substr(0, size), host_utime);
    bytes.remove_prefix(std::min(size, bytes.size()));
    if (i % 16 == 5 && protocol.deadline()) {
      host_utime = std::max(host_utime, *protocol.deadline());
      protocol.expire(host_utime);
    }
    if (!protocol.failure().empty()) protocol.connected(host_utime);
    protocol.condition();
    protocol.take_to_send();
    for (const device::Measurement& measurement : protocol.take_measurements()) {
      const bus::Message message =
          std::visit([](const auto& m) { return bus::Message(m); }, measurement);
      const bus::Channel channel = bus::channel_of(message);
      const std::vector<std::uint8_t> encoded = bus::encode(message);
      const auto decoded = bus::decode(channel, encoded.data(), encoded.size());
      if (std::holds_alternative<bus::Rejection>(decoded)) std::abort();
      const std::int64_t utime = bus::utime_of(message);
      if (last_utime.count(channel) != 0 && utime <= last_utime[channel]) std::abort();
      last_utime[channel] = utime;
    }
    // Last, as a driver does it: what was measured before the step has been taken.
    if (i % 64 == 63) {
      const std::int64_t step_us = i % 128 == 63 ? 3'600'000'000 : -3'600'000'000;
      host_utime += step_us;
      protocol.host_clock_stepped(step_us);
      last_utime.clear();
    }
  }
}

}  // namespace orchard::fuzz
