// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace orchard::bus {

/// Keeps from LCM's socket the datagrams that LCM 1.3.1 does not survive.
///
/// LCM reads them in a thread of its own, before any code of ours: a name without an end or a
/// fragment whose offset wraps makes it copy gigabytes (github.com/lcm-proj/lcm, pull request 628).
/// So the kernel drops them, by a classic BPF filter on the socket (SO_ATTACH_FILTER; no privilege
/// is needed, and where LCM is mended it costs nothing).
class SocketGuard {
 public:
  /// Remembers which sockets there are; call it before LCM makes its own.
  SocketGuard();

  /// Puts the filter on every IPv4 datagram socket that has come since. How many there were.
  ///
  /// lcm_get_fileno() is of no help: in LCM 1.3.1 it is a pipe that LCM's thread writes to. The
  /// socket is the one that was not there before.
  int attach();

  /// From now on only datagrams of these channels reach the guarded sockets, in place of those of
  /// an earlier call: a group of LCM has one address, and everybody would be woken for each
  /// picture. What LCM itself cut into several datagrams (above 64 kB) passes: only the first names
  /// a channel.
  void listen_to(const std::vector<std::string>& channels);

  /// Datagrams that the kernel has dropped on the guarded sockets: refused by the filter, of other
  /// channels than are listened to, or more than the receive buffer holds.
  std::int64_t num_dropped() const;

 private:
  std::vector<int> before_;
  std::vector<int> guarded_;
};

/// Whether this kernel (or container) lets a plain process filter its own sockets.
bool socket_filters_work();

}  // namespace orchard::bus
