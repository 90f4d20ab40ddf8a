// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace orchard::cli {

/// A udpm URL taken apart.
struct UdpmUrl {
  std::string address = "239.255.76.67";
  int port = 7667;
  int ttl = 0;
  std::int64_t recv_buf_size = 0;  ///< 0: the system's default
};

/// None when it is no udpm URL with a multicast address.
std::optional<UdpmUrl> parse_udpm_url(const std::string& url);

struct NetworkInterface {
  std::string name;
  bool up = false;
  bool loopback = false;
  bool multicast = false;
  bool has_ipv4 = false;
};

/// In the kernel's order.
std::vector<NetworkInterface> network_interfaces();

/// The interface that datagrams to `address` leave by, or none when there is no route.
std::optional<std::string> route_to(const std::string& address);

/// A kernel setting by its path below /proc/sys ("net/core/rmem_max"); none where it cannot be
/// read.
std::optional<std::int64_t> kernel_setting(const std::string& name);

/// Whether a datagram that is too short for LCM reaches a plain socket of this machine: with the
/// guard of config/deploy it does not. None when that cannot be tried.
std::optional<bool> runts_arrive(const UdpmUrl& url);

/// How many sockets of any process are bound to the UDP port.
int num_sockets_on_port(int port);

}  // namespace orchard::cli
