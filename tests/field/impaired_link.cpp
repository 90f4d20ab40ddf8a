// SPDX-License-Identifier: BSD-3-Clause
// impaired_link IF_A IF_B [--loss P] [--duplicate P] [--jitter-ms J] [--whole 0|1] [--seed N]:
// carries Ethernet frames between two interfaces as a bad cable or radio would. Each frame, in
// either direction, is lost with probability P (with --whole 1 together with all others of its
// datagram), sent twice with probability P, and held for a random time up to J, so that later ones
// overtake it. SIGUSR1 cuts the link, SIGUSR2 mends it; SIGTERM prints the counts and ends. Needs
// the right to open packet sockets.
#include <arpa/inet.h>
#include <linux/if_packet.h>
#include <net/ethernet.h>
#include <net/if.h>
#include <poll.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using Frame = std::vector<unsigned char>;

constexpr int kFrameMax_bytes = 65600;

struct Impairment {
  double loss = 0.0;
  double duplicate = 0.0;
  double jitter_ms = 0.0;
  bool whole = false;
  unsigned seed = 1;
};

/// A packet socket on an interface that hears what arrives there, or -1.
int open_interface(const char* name) {
  const int fd = socket(AF_PACKET, SOCK_RAW, htons(ETH_P_ALL));
  if (fd < 0) return -1;
  sockaddr_ll own{};
  own.sll_family = AF_PACKET;
  own.sll_protocol = htons(ETH_P_ALL);
  own.sll_ifindex = static_cast<int>(if_nametoindex(name));
  const int yes = 1;
  const int buffer_bytes = 16 << 20;
  setsockopt(fd, SOL_PACKET, PACKET_IGNORE_OUTGOING, &yes, sizeof(yes));
  setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &buffer_bytes, sizeof(buffer_bytes));
  setsockopt(fd, SOL_SOCKET, SO_SNDBUFFORCE, &buffer_bytes, sizeof(buffer_bytes));
  if (own.sll_ifindex == 0 || bind(fd, reinterpret_cast<const sockaddr*>(&own), sizeof(own)) != 0) {
    return -1;
  }
  return fd;
}

/// What an Ethernet frame carries of a datagram of LCM.
struct Carried {
  std::uint64_t datagram = 0;  // of its first bytes behind LCM's sequence number
  std::uint64_t offset = 0;    // of the frame's bytes in the datagram
};

/// Tells by headers which datagram of LCM a frame belongs to.
///
/// Which frames are lost must not hang on timing or on numbers that the kernel or the sender count
/// up, or a test's outcome would change from run to run: what a message says is the same each time.
class MessageReader {
 public:
  /// What a frame carries, or nothing: not LCM, or its beginning was not seen.
  std::optional<Carried> read(const Frame& frame, std::size_t size_bytes) {
    constexpr std::size_t kIp = 14;  // behind the Ethernet header
    if (size_bytes < kIp + 20 || number(frame, 12, 2) != ETHERTYPE_IP) return std::nullopt;
    const std::uint64_t sender = number(frame, kIp + 12, 4);
    const auto datagram = std::make_pair(sender, number(frame, kIp + 4, 2));
    const std::uint64_t offset = (number(frame, kIp + 6, 2) & 0x1fff) * 8;
    const std::size_t lcm = kIp + (frame[kIp] & 0x0f) * 4 + 8;  // behind the IP and UDP headers
    if (offset == 0) {
      datagrams_.erase(datagram);
      if (size_bytes < lcm + 20) return std::nullopt;
      const std::uint64_t magic = number(frame, lcm, 4);
      if (magic != kShortMessage && magic != kFragment) return std::nullopt;
      datagrams_[datagram] = mixed_bytes(frame, lcm + 8, size_bytes);
    }
    const auto found = datagrams_.find(datagram);
    if (found == datagrams_.end()) return std::nullopt;
    return Carried{found->second, offset};
  }

 private:
  static constexpr std::uint64_t kShortMessage = 0x4c433032;  // "LC02"
  static constexpr std::uint64_t kFragment = 0x4c433033;      // "LC03"

  /// FNV-1a.
  static std::uint64_t mixed_bytes(const Frame& frame, std::size_t begin, std::size_t end) {
    std::uint64_t mixed = 0xcbf29ce484222325ULL;
    for (std::size_t i = begin; i < end; ++i) mixed = (mixed ^ frame[i]) * 0x100000001b3ULL;
    return mixed;
  }

  static std::uint64_t number(const Frame& frame, std::size_t at, std::size_t size_bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size_bytes; ++i) value = (value << 8) | frame[at + i];
    return value;
  }

  std::map<std::pair<std::uint64_t, std::uint64_t>, std::uint64_t>
      datagrams_;  // by sender and IP number
};

/// A number in [0, 1) that looks drawn and is the same for the same input.
double drawn_for(const Carried& carried, unsigned seed) {
  std::uint64_t mixed = seed;
  for (const std::uint64_t value : {carried.datagram, carried.offset}) {
    mixed = (mixed ^ value) + 0x9e3779b97f4a7c15ULL;
    mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9ULL;
    mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebULL;
    mixed ^= mixed >> 31;
  }
  return static_cast<double>(mixed >> 11) * 0x1p-53;
}

class Link {
 public:
  Link(int fd_a, int fd_b, const Impairment& impairment)
      : fds_{fd_a, fd_b}, impairment_(impairment), random_(impairment.seed) {}

  /// Takes every frame that waits at one end.
  void take(int end) {
    Frame frame(kFrameMax_bytes);
    for (;;) {
      const ssize_t size = recv(fds_[end], frame.data(), frame.size(), MSG_DONTWAIT);
      if (size <= 0) return;
      ++num_frames_;
      double lose = uniform_(random_);
      const double repeat = uniform_(random_);
      const double first = uniform_(random_);
      const double second = uniform_(random_);
      if (auto carried = reader_.read(frame, static_cast<std::size_t>(size))) {
        if (impairment_.whole) carried->offset = 0;
        lose = drawn_for(*carried, impairment_.seed);
      }
      if (is_cut_ || lose < impairment_.loss) {
        ++num_lost_;
        continue;
      }
      const Frame whole(frame.begin(), frame.begin() + size);
      hold(end, whole, first);
      if (repeat < impairment_.duplicate) {
        ++num_repeated_;
        hold(end, whole, second);
      }
    }
  }

  /// Sends what is due; the time until the next is due, -1 for none waiting [ms].
  int send_due() {
    while (!waiting_.empty() && waiting_.begin()->first <= Clock::now()) {
      const auto& [end, frame] = waiting_.begin()->second;
      if (send(fds_[1 - end], frame.data(), frame.size(), 0) < 0) ++num_unsent_;
      waiting_.erase(waiting_.begin());
    }
    if (waiting_.empty()) return -1;
    const auto left = waiting_.begin()->first - Clock::now();
    return std::max<int>(
        0, static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count()));
  }

  void cut(bool is_cut) { is_cut_ = is_cut; }

  void report() const {
    std::printf("frames %lld lost %lld repeated %lld unsent %lld\n", num_frames_, num_lost_,
                num_repeated_, num_unsent_);
  }

 private:
  void hold(int end, const Frame& frame, double fraction) {
    const std::chrono::duration<double, std::milli> wait(fraction * impairment_.jitter_ms);
    waiting_.emplace(Clock::now() + std::chrono::duration_cast<Clock::duration>(wait),
                     std::make_pair(end, frame));
  }

  int fds_[2];
  Impairment impairment_;
  MessageReader reader_;
  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
  std::multimap<Clock::time_point, std::pair<int, Frame>> waiting_;
  bool is_cut_ = false;
  long long num_frames_ = 0, num_lost_ = 0, num_repeated_ = 0, num_unsent_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) return 2;
  Impairment impairment;
  for (int i = 3; i + 1 < argc; i += 2) {
    const std::string option = argv[i];
    if (option == "--loss") {
      impairment.loss = std::atof(argv[i + 1]);
    } else if (option == "--duplicate") {
      impairment.duplicate = std::atof(argv[i + 1]);
    } else if (option == "--jitter-ms") {
      impairment.jitter_ms = std::atof(argv[i + 1]);
    } else if (option == "--whole") {
      impairment.whole = std::atoi(argv[i + 1]) != 0;
    } else if (option == "--seed") {
      impairment.seed = static_cast<unsigned>(std::atoi(argv[i + 1]));
    } else {
      return 2;
    }
  }
  const int fds[2] = {open_interface(argv[1]), open_interface(argv[2])};
  if (fds[0] < 0 || fds[1] < 0) {
    std::perror("impaired_link");
    return 1;
  }
  sigset_t signals;
  sigemptyset(&signals);
  for (const int number : {SIGUSR1, SIGUSR2, SIGTERM, SIGINT}) sigaddset(&signals, number);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  const int signal_fd = signalfd(-1, &signals, 0);
  Link link(fds[0], fds[1], impairment);
  std::printf("ready\n");
  std::fflush(stdout);
  pollfd waiting[3] = {{fds[0], POLLIN, 0}, {fds[1], POLLIN, 0}, {signal_fd, POLLIN, 0}};
  for (;;) {
    poll(waiting, 3, link.send_due());
    for (int end = 0; end < 2; ++end) {
      if ((waiting[end].revents & POLLIN) != 0) link.take(end);
    }
    if ((waiting[2].revents & POLLIN) == 0) continue;
    signalfd_siginfo signal{};
    if (read(signal_fd, &signal, sizeof(signal)) != sizeof(signal)) continue;
    if (signal.ssi_signo == SIGTERM || signal.ssi_signo == SIGINT) break;
    link.cut(signal.ssi_signo == SIGUSR1);
  }
  link.report();
  return 0;
}
