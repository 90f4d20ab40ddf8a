// SPDX-License-Identifier: BSD-3-Clause
// hostile_sender PORT COUNT SEED: sends COUNT broken datagrams to LCM's multicast group: runts,
// wrong magic, huge array counts, fragments that overlap, lie or wrap, random changes of valid
// messages.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

#include "bus/messages/codec.hpp"
#include "node/bus/fake_log.hpp"
#include "system/bus/multicast_socket.hpp"

namespace {

using Bytes = std::vector<std::uint8_t>;

void put_u32(Bytes& bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

void put_u16(Bytes& bytes, std::uint32_t value) {
  bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

/// LCM's short datagram: magic "LC02", sequence number, channel name, message.
Bytes short_datagram(std::uint32_t number, const std::string& channel, const Bytes& payload) {
  Bytes bytes;
  put_u32(bytes, 0x4c433032);
  put_u32(bytes, number);
  bytes.insert(bytes.end(), channel.begin(), channel.end());
  bytes.push_back(0);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

/// LCM's fragment: magic "LC03", sequence number, size, offset, fragment number and count.
Bytes fragment(std::mt19937& random, std::uint32_t number, const Bytes& payload) {
  Bytes bytes;
  put_u32(bytes, 0x4c433033);
  put_u32(bytes, number % 7);
  put_u32(bytes, random() % 3 == 0 ? random() : static_cast<std::uint32_t>(payload.size()));
  put_u32(bytes, random() % 2 == 0 ? 0 : random() % 100000);
  const std::uint32_t fragment_number = random() % 3;
  put_u16(bytes, fragment_number);
  put_u16(bytes, random() % 4);
  if (fragment_number == 0) {
    const char channel[] = "SCAN";
    bytes.insert(bytes.end(), channel, channel + sizeof(channel));
  }
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

/// Two fragments of a message of 3000 bytes; the second's offset and length add up to less than
/// its length in 32 bits. LCM 1.3.1 alone writes before the buffer (its pull request 628).
Bytes wrapping_fragment(std::uint32_t number, bool first) {
  Bytes bytes;
  put_u32(bytes, 0x4c433033);
  put_u32(bytes, 100000 + number);
  put_u32(bytes, 3000);
  put_u32(bytes, first ? 0 : 0xFFFFFFF0);
  put_u16(bytes, first ? 0 : 1);
  put_u16(bytes, 3);
  if (first) {
    const char channel[] = "SCAN";
    bytes.insert(bytes.end(), channel, channel + sizeof(channel));
  }
  bytes.resize(bytes.size() + 900, 0x55);
  return bytes;
}

/// A first fragment that ends within its name: LCM 1.3.1 reads on in what came before, and takes
/// the length that is left for four gigabytes.
Bytes nameless_fragment(std::uint32_t number) {
  Bytes bytes;
  put_u32(bytes, 0x4c433033);
  put_u32(bytes, 200000 + number);
  put_u32(bytes, 3000);
  put_u32(bytes, 8);
  put_u16(bytes, 0);
  put_u16(bytes, 2);
  for (const char c : {'S', 'C'}) bytes.push_back(static_cast<std::uint8_t>(c));
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  using namespace orchard;
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  const sockaddr_in to = testing::socket_address("239.255.76.67", std::atoi(argv[1]));
  std::mt19937 random(static_cast<unsigned>(std::atoi(argv[3])));
  const std::vector<bus::Message> valid = bus::testing::fake_drive(2, 400);
  const int count = std::atoi(argv[2]);
  for (int i = 0; i < count; ++i) {
    const bus::Message& message = valid[random() % valid.size()];
    const std::string channel(bus::info(bus::channel_of(message)).name);
    Bytes payload = bus::encode(message);
    Bytes datagram;
    switch (random() % 9) {
      case 6:
        datagram = wrapping_fragment(static_cast<std::uint32_t>(i), true);
        sendto(fd, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to),
               sizeof(to));
        datagram = wrapping_fragment(static_cast<std::uint32_t>(i), false);
        break;
      case 7:
        datagram = nameless_fragment(static_cast<std::uint32_t>(i));
        break;
      case 0:  // a runt: shorter than its own header
        datagram.assign(random() % 12, static_cast<std::uint8_t>(random()));
        if (datagram.size() >= 4) std::memcpy(datagram.data(), "LC02", 4);
        break;
      case 1: {  // hash, utime and a huge count, and nothing behind them
        payload.resize(24);
        payload[20] = random() % 2 == 0 ? 0x7F : 0xFF;
        datagram = short_datagram(static_cast<std::uint32_t>(i), channel, payload);
        break;
      }
      case 2:  // a name without an end
        datagram = short_datagram(static_cast<std::uint32_t>(i), std::string(200, 'A'), {});
        datagram.pop_back();
        break;
      case 3:
        datagram = fragment(random, static_cast<std::uint32_t>(i), payload);
        break;
      case 4:  // some bytes changed
        for (int k = 0; k < 4; ++k) {
          payload[random() % payload.size()] = static_cast<std::uint8_t>(random());
        }
        datagram = short_datagram(static_cast<std::uint32_t>(i), channel, payload);
        break;
      default:  // cut (twice as often)
        payload.resize(random() % payload.size());
        datagram = short_datagram(static_cast<std::uint32_t>(i), channel, payload);
    }
    sendto(fd, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to),
           sizeof(to));
    // The receiver is to see them, not its socket buffer to drop them.
    if (i % 50 == 49) {
      timespec pause{0, 2000000};
      nanosleep(&pause, nullptr);
    }
  }
  return 0;
}
