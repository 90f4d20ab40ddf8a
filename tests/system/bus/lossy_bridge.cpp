// SPDX-License-Identifier: BSD-3-Clause
// lossy_bridge PORT_A PORT_B N: carries LCM datagrams between two ports of a group and loses every
// Nth, as a bad radio link would. Runs until killed.
#include <poll.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

#include "system/bus/multicast_socket.hpp"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const std::string group = "239.255.76.67";
  const int ports[2] = {std::atoi(argv[1]), std::atoi(argv[2])};
  const int lose_every = std::atoi(argv[3]);
  int receivers[2];
  for (int i = 0; i < 2; ++i) receivers[i] = orchard::testing::join_group(group, ports[i]);
  const int sender = socket(AF_INET, SOCK_DGRAM, 0);
  const sockaddr_in any = orchard::testing::socket_address("0.0.0.0", 0);
  if (bind(sender, reinterpret_cast<const sockaddr*>(&any), sizeof(any)) != 0) return 1;
  sockaddr_in own{};
  socklen_t length = sizeof(own);
  getsockname(sender, reinterpret_cast<sockaddr*>(&own), &length);
  std::vector<char> datagram(65536);
  pollfd waiting[2] = {{receivers[0], POLLIN, 0}, {receivers[1], POLLIN, 0}};
  long long count = 0;
  while (poll(waiting, 2, -1) > 0) {
    for (int i = 0; i < 2; ++i) {
      if ((waiting[i].revents & POLLIN) == 0) continue;
      sockaddr_in from{};
      length = sizeof(from);
      const ssize_t size = recvfrom(receivers[i], datagram.data(), datagram.size(), 0,
                                    reinterpret_cast<sockaddr*>(&from), &length);
      if (size < 0 || from.sin_port == own.sin_port) continue;  // what the bridge sent itself
      if (++count % lose_every == 0) continue;
      const sockaddr_in to = orchard::testing::socket_address(group, ports[1 - i]);
      sendto(sender, datagram.data(), static_cast<std::size_t>(size), 0,
             reinterpret_cast<const sockaddr*>(&to), sizeof(to));
    }
  }
  return 1;
}
