// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace orchard::bus {

/// Protects LCM's socket from malformed datagrams that crash LCM 1.3.1.
///
/// LCM parses datagrams in its own thread, before any of our code: an unterminated channel name or
/// a fragment offset that wraps around makes it copy gigabytes (github.com/lcm-proj/lcm, pull
/// request 628). A classic BPF filter on the socket (SO_ATTACH_FILTER, no privilege needed) makes
/// the kernel drop them; it is harmless for fixed versions of LCM.
class SocketGuard {
 public:
  /// Records which sockets are already open. Construct it before LCM opens its socket.
  SocketGuard();

  /// Attaches the filter to every IPv4 datagram socket opened since construction. Returns their
  /// number.
  ///
  /// The socket must be found this way because lcm_get_fileno() of LCM 1.3.1 returns a pipe that
  /// LCM's thread writes to.
  int attach();

  /// Lets only datagrams of these channels through, replacing the list of an earlier call. All
  /// channels of an LCM network share one multicast address, so without the filter each image would
  /// wake every process. Fragmented messages (above 64 kB) always pass, because only the first
  /// fragment contains the channel name.
  void listen_to(const std::vector<std::string>& channels);

  /// Number of datagrams that the kernel dropped on the guarded sockets: malformed ones, other
  /// channels, and receive buffer overflow.
  std::int64_t num_dropped() const;

 private:
  std::vector<int> before_;
  std::vector<int> guarded_;
};

/// Whether this kernel (or container) allows an unprivileged process to filter its own sockets.
bool socket_filters_work();

}  // namespace orchard::bus
