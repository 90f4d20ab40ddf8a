// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace orchard::cli {

/// The parts of a udpm URL.
struct UdpmUrl {
  std::string address = "239.255.76.67";
  int port = 7667;
  int ttl = 0;
  std::int64_t recv_buf_size = 0;  ///< 0: the system's default
};

/// Parses a udpm URL; none unless it is one with a multicast address.
std::optional<UdpmUrl> parse_udpm_url(const std::string& url);

struct NetworkInterface {
  std::string name;
  bool up = false;
  bool loopback = false;
  bool multicast = false;
  bool has_ipv4 = false;
};

/// The network interfaces, in the kernel's order.
std::vector<NetworkInterface> network_interfaces();

/// The outgoing interface of datagrams to `address`; none without a route.
std::optional<std::string> route_to(const std::string& address);

/// Reads a kernel setting by its path below /proc/sys ("net/core/rmem_max"); none when unreadable.
std::optional<std::int64_t> kernel_setting(const std::string& name);

/// Tests whether a datagram that is too short for LCM reaches a plain socket of this machine; the
/// guard of config/deploy blocks it. None when the test is impossible.
std::optional<bool> runts_arrive(const UdpmUrl& url);

/// Number of sockets, of any process, bound to the UDP port.
int num_sockets_on_port(int port);

}  // namespace orchard::cli
