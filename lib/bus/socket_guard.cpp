// SPDX-License-Identifier: BSD-3-Clause
#include "bus/socket_guard.hpp"

#include <dirent.h>
#include <linux/filter.h>
#include <linux/sock_diag.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>
#include <utility>

namespace orchard::bus {
namespace {

// LCM's datagram header (lcm/udpm_util.h of LCM 1.3.1): four bytes of magic number (whole message
// or fragment), a sequence number, and for a fragment the total size, offset, fragment number and
// fragment count. The filter sees the UDP header in front of it.
constexpr std::uint32_t kUdpHeader = 8;
constexpr std::uint32_t kWhole = 0x4c433032;     // LC02
constexpr std::uint32_t kFragment = 0x4c433033;  // LC03
constexpr std::uint32_t kWholeHeader = kUdpHeader + 8;
constexpr std::uint32_t kSizeAt = kUdpHeader + 8;
constexpr std::uint32_t kOffsetAt = kUdpHeader + 12;
constexpr std::uint32_t kNumberAt = kUdpHeader + 16;
constexpr std::uint32_t kFragmentHeader = kUdpHeader + 20;
constexpr std::uint32_t kNameMax = 64;  // with terminating zero

/// Max message size of the protocol (lcmtypes/README.md).
constexpr std::uint32_t kMessageMax = 16U << 20;

constexpr std::uint32_t kPassAll = 0x40000;

using Program = std::vector<sock_filter>;

void put(Program& program, int code, std::uint32_t k, std::uint8_t jump_true = 0,
         std::uint8_t jump_false = 0) {
  program.push_back({static_cast<std::uint16_t>(code), jump_true, jump_false, k});
}

/// Passes a datagram whose channel name is terminated. A load beyond the datagram's end drops it.
void put_name_check(Program& program, std::uint32_t name_at) {
  for (std::uint32_t i = 0; i < kNameMax; ++i) {
    const auto to_pass = static_cast<std::uint8_t>(2 * (kNameMax - 1 - i) + 1);
    put(program, BPF_LD | BPF_B | BPF_ABS, name_at + i);
    put(program, BPF_JMP | BPF_JEQ | BPF_K, 0, to_pass, 0);
  }
  put(program, BPF_RET | BPF_K, 0);
  put(program, BPF_RET | BPF_K, kPassAll);
}

/// A channel name with its terminating zero, split into loads of four, two and one byte.
std::vector<std::pair<int, std::uint32_t>> loads_of(const std::string& channel) {
  const std::string name = channel + '\0';
  std::vector<std::pair<int, std::uint32_t>> loads;
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t left = name.size() - at, width = left >= 4 ? 4 : left >= 2 ? 2 : 1;
    std::uint32_t value = 0;
    for (const std::size_t end = at + width; at < end; ++at) {
      value = value << 8 | static_cast<std::uint8_t>(name[at]);
    }
    loads.emplace_back(width == 4 ? BPF_W : width == 2 ? BPF_H : BPF_B, value);
  }
  return loads;
}

/// Passes a datagram of one of these channels. A load beyond its end drops it; short names are
/// compared first, so only a name that is not listed can reach the end.
void put_channels(Program& program, std::uint32_t name_at, std::vector<std::string> channels) {
  std::sort(channels.begin(), channels.end(),
            [](const std::string& a, const std::string& b) { return a.size() < b.size(); });
  for (const std::string& channel : channels) {
    const auto loads = loads_of(channel);
    std::uint32_t at = name_at;
    for (std::size_t i = 0; i < loads.size(); ++i) {
      const auto to_next = static_cast<std::uint8_t>(2 * (loads.size() - 1 - i) + 1);
      put(program, BPF_LD | loads[i].first | BPF_ABS, at);
      put(program, BPF_JMP | BPF_JEQ | BPF_K, loads[i].second, 0, to_next);
      at += loads[i].first == BPF_W ? 4 : loads[i].first == BPF_H ? 2 : 1;
    }
    put(program, BPF_RET | BPF_K, kPassAll);
  }
  put(program, BPF_RET | BPF_K, 0);
}

/// `channels`: nullptr for all.
Program make_program(const std::vector<std::string>* channels = nullptr) {
  Program whole;
  if (channels != nullptr) {
    put_channels(whole, kWholeHeader, *channels);
  } else {
    put_name_check(whole, kWholeHeader);
  }
  Program first_fragment;
  put_name_check(first_fragment, kFragmentHeader);
  Program program;
  put(program, BPF_LD | BPF_W | BPF_ABS, kUdpHeader);
  put(program, BPF_JMP | BPF_JEQ | BPF_K, kWhole, 0, 1);
  put(program, BPF_JMP | BPF_JA, 10 + static_cast<std::uint32_t>(first_fragment.size()));
  put(program, BPF_JMP | BPF_JEQ | BPF_K, kFragment, 1, 0);
  put(program, BPF_RET | BPF_K, 0);
  put(program, BPF_LD | BPF_W | BPF_ABS, kSizeAt);
  put(program, BPF_JMP | BPF_JGT | BPF_K, kMessageMax, 5, 0);
  // A larger offset plus the length could wrap at 2^32.
  put(program, BPF_LD | BPF_W | BPF_ABS, kOffsetAt);
  put(program, BPF_JMP | BPF_JGT | BPF_K, kMessageMax, 3, 0);
  put(program, BPF_LD | BPF_H | BPF_ABS, kNumberAt);
  put(program, BPF_JMP | BPF_JEQ | BPF_K, 0, 2, 0);
  put(program, BPF_RET | BPF_K, kPassAll);
  put(program, BPF_RET | BPF_K, 0);
  program.insert(program.end(), first_fragment.begin(), first_fragment.end());
  program.insert(program.end(), whole.begin(), whole.end());
  return program;
}

bool attach_filter(int fd, Program program = make_program()) {
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  return setsockopt(fd, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof(filter)) == 0;
}

int option(int fd, int name) {
  int value = -1;
  socklen_t size = sizeof(value);
  return getsockopt(fd, SOL_SOCKET, name, &value, &size) == 0 ? value : -1;
}

/// All IPv4 datagram sockets of this process.
std::vector<int> datagram_sockets() {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir("/proc/self/fd"), closedir);
  std::vector<int> sockets;
  if (!folder) return sockets;
  while (const dirent* entry = readdir(folder.get())) {
    if (entry->d_name[0] == '.') continue;
    const int fd = std::atoi(entry->d_name);
    if (option(fd, SO_TYPE) == SOCK_DGRAM && option(fd, SO_DOMAIN) == AF_INET) {
      sockets.push_back(fd);
    }
  }
  return sockets;
}

}  // namespace

SocketGuard::SocketGuard() : before_(datagram_sockets()) {}

int SocketGuard::attach() {
  int num_new = 0;
  for (const int fd : datagram_sockets()) {
    if (std::count(before_.begin(), before_.end(), fd) > 0 || !attach_filter(fd)) continue;
    guarded_.push_back(fd);
    ++num_new;
  }
  return num_new;
}

void SocketGuard::listen_to(const std::vector<std::string>& channels) {
  for (const int fd : guarded_) attach_filter(fd, make_program(&channels));
}

std::int64_t SocketGuard::num_dropped() const {
  std::int64_t sum = 0;
  for (const int fd : guarded_) {
    std::array<std::uint32_t, SK_MEMINFO_VARS> info{};
    socklen_t size = sizeof(info);
    if (getsockopt(fd, SOL_SOCKET, SO_MEMINFO, info.data(), &size) == 0) {
      sum += info[SK_MEMINFO_DROPS];
    }
  }
  return sum;
}

bool socket_filters_work() {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  const bool works = attach_filter(fd);
  close(fd);
  return works;
}

}  // namespace orchard::bus
