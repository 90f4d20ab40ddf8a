// SPDX-License-Identifier: BSD-3-Clause
// Fuzzes the guarded decode of every type. The first byte chooses the channel; the type's hash is
// put in place, since no fuzzer would guess it, unless the second byte is odd.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <variant>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/messages/field_codec.hpp"
#include "bus/messages/service_messages.hpp"
#include "fuzz/fuzz_seeds.hpp"
#include "unit/bus/sample_messages.hpp"

namespace {

using namespace orchard;

/// The first eight bytes of any message of the channel.
std::vector<std::uint8_t> hash_of(bus::Channel channel) {
  return bus::FieldWriter(bus::type_hash(channel)).bytes();
}

/// What the guard lets through must encode to the very bytes that came in: nothing repaired. A
/// message of an earlier release's type (its hash comes first) is sent on as one of today's.
template <class Decoded>
void check(const Decoded& decoded, const std::vector<std::uint8_t>& bytes) {
  if (std::holds_alternative<bus::Rejection>(decoded)) return;
  const std::vector<std::uint8_t> encoded = bus::encode(std::get<0>(decoded));
  const bool is_todays = std::equal(encoded.begin(), encoded.begin() + 8, bytes.begin());
  if (is_todays && encoded != bytes) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const auto channel = static_cast<bus::Channel>(data[0] % bus::kNumChannels);
  std::vector<std::uint8_t> bytes(data + 2, data + size);
  if (data[1] % 2 == 0) {
    static const std::vector<std::vector<std::uint8_t>> hashes = [] {
      std::vector<std::vector<std::uint8_t>> all;
      for (const bus::ChannelInfo& info : bus::kChannels) all.push_back(hash_of(info.channel));
      return all;
    }();
    const auto& hash = hashes[static_cast<std::size_t>(channel)];
    bytes.insert(bytes.begin(), hash.begin(), hash.end());
  }
  switch (channel) {
    case bus::Channel::kStatus:
      check(bus::decode_status(bytes.data(), bytes.size()), bytes);
      break;
    case bus::Channel::kConfig:
      check(bus::decode_config(bytes.data(), bytes.size()), bytes);
      break;
    case bus::Channel::kAck:
      check(bus::decode_ack(bytes.data(), bytes.size()), bytes);
      break;
    case bus::Channel::kReplay:
      check(bus::decode_replay(bytes.data(), bytes.size()), bytes);
      break;
    default:
      check(bus::decode(channel, bytes.data(), bytes.size()), bytes);
  }
  return 0;
}

namespace orchard::fuzz {

std::vector<std::string> seeds() {
  std::vector<std::string> seeds;
  const auto add = [&seeds](bus::Channel channel, const std::vector<std::uint8_t>& bytes) {
    std::string seed{static_cast<char>(channel), '\0'};
    seed.append(bytes.begin() + 8, bytes.end());  // its hash is put back for every input
    seeds.push_back(seed);
  };
  for (const bus::Message& message : bus::testing::sample_messages()) {
    add(bus::channel_of(message), bus::encode(message));
  }
  bus::Status status;
  status.name = "orchard-detector";
  status.text = "waits";
  add(bus::Channel::kStatus, bus::encode(status));
  add(bus::Channel::kConfig,
      bus::encode(bus::ConfigNotice{1, 2, 3, "orchard-pose", "0.1", "a: 1"}));
  add(bus::Channel::kAck,
      bus::encode(bus::Ack{1, 2, 1, bus::Channel::kScan, {{bus::Channel::kPose, 3}}}));
  add(bus::Channel::kReplay, bus::encode(bus::ReplayMark{1, 0, false}));
  return seeds;
}

}  // namespace orchard::fuzz
