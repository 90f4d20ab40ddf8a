// SPDX-License-Identifier: BSD-3-Clause
// flood_sender PORT SECONDS: well-formed SCAN messages to LCM's group, as many as go out.
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "bus/messages/codec.hpp"
#include "node/bus/fake_log.hpp"
#include "system/bus/multicast_socket.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  using namespace orchard;
  using Clock = std::chrono::steady_clock;
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  const sockaddr_in to = testing::socket_address("239.255.76.67", std::atoi(argv[1]));
  auto scan = std::get<laser::Scan>(bus::testing::fake_drive(1).front());
  const auto end = Clock::now() + std::chrono::seconds(std::atoi(argv[2]));
  long num = 0;
  while (Clock::now() < end) {
    scan.utime += 1000;
    ++scan.seq;
    std::vector<std::uint8_t> datagram{'L', 'C', '0', '2', 0, 0, 0, 0, 'S', 'C', 'A', 'N', 0};
    const auto bytes = bus::encode(bus::Message(scan));
    datagram.insert(datagram.end(), bytes.begin(), bytes.end());
    for (int i = 0; i < 50; ++i) {
      num += sendto(fd, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                    sizeof(to)) > 0;
    }
  }
  std::printf("%ld sent\n", num);
  return 0;
}
