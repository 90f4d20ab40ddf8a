// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/lockstep_protocol.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>

#include "orchard/ack_t.hpp"

namespace orchard::bus {
namespace {

constexpr int kPortsApart = 10'000;
constexpr int kPortMax = 65'535;

/// LCM's defaults for a URL without address or port.
constexpr std::string_view kDefaultAddress = "239.255.76.67";
constexpr int kDefaultPort = 7667;

}  // namespace

std::string lockstep_url(const std::string& lcm_url) {
  constexpr std::string_view kScheme = "udpm://";
  if (lcm_url.compare(0, kScheme.size(), kScheme) != 0) return lcm_url;
  const std::size_t end = std::min(lcm_url.find('?'), lcm_url.size());
  const std::string network = lcm_url.substr(kScheme.size(), end - kScheme.size());
  const std::size_t colon = std::min(network.find(':'), network.size());
  std::string address = network.substr(0, colon);
  if (address.empty()) address = kDefaultAddress;
  int port = kDefaultPort;
  if (colon < network.size()) {
    const char* text = network.data() + colon + 1;
    const auto read = std::from_chars(text, network.data() + network.size(), port);
    if (read.ec != std::errc()) return lcm_url;  // LCM reports the error
  }
  port += port + kPortsApart <= kPortMax ? kPortsApart : -kPortsApart;
  return std::string(kScheme) + address + ":" + std::to_string(port) + lcm_url.substr(end);
}

std::int8_t node_number(std::string_view name) {
  if (name == "detector") return ack_t::DETECTOR;
  if (name == "pose") return ack_t::POSE;
  if (name == "mapper") return ack_t::MAPPER;
  throw std::invalid_argument("lockstep knows the nodes detector, pose and mapper, not \"" +
                              std::string(name) + "\"");
}

std::int8_t sender_of(Channel channel) {
  if (channel == Channel::kDetections) return ack_t::DETECTOR;
  if (channel == Channel::kPose || channel == Channel::kTrajectory) return ack_t::POSE;
  return ack_t::MAPPER;
}

std::optional<LockstepSteps> steps_of(const Ack& ack, const std::vector<OutputId>& round) {
  LockstepSteps made;
  for (const OutputId& id : ack.outputs) {
    if (made.size() < round.size() && id == round[made.size()]) {
      made.emplace_back();
    } else if (made.empty()) {
      return std::nullopt;
    } else {
      made.back().push_back(id);
    }
  }
  return made;
}

}  // namespace orchard::bus
