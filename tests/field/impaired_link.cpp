// SPDX-License-Identifier: BSD-3-Clause
// impaired_link IF_A IF_B [--loss P] [--duplicate P] [--jitter-ms J]
// [--whole 0|1] [--seed N]: carries Ethernet
// frames between two interfaces as a bad cable or radio would. Each frame, in either direction, is
// lost with probability P (with --whole 1 together with all fragments of its datagram), sent twice
// with probability P, and held for a random time up to J, so that later ones overtake it. SIGUSR1
// cuts the link, SIGUSR2 mends it; SIGTERM prints the counts and ends. Needs the right to open
// packet sockets.
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

/// A number in [0, 1) that all fragments of one IPv4 datagram share; of other frames, of the frame.
double datagram_number(const Frame& frame, std::size_t size, unsigned seed, double otherwise) {
  constexpr std::size_t kIp = 14;  // behind the Ethernet header
  if (size < kIp + 20 || frame[12] != 0x08 || frame[13] != 0x00) return otherwise;
  std::uint64_t mixed = seed;
  for (const std::size_t at : {kIp + 4, kIp + 5, kIp + 12, kIp + 13, kIp + 14, kIp + 15}) {
    mixed = (mixed ^ frame[at]) * 0x100000001b3ULL;
  }
  mixed = (mixed ^ (mixed >> 30)) * 0xbf58476d1ce4e5b9ULL;
  mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>((mixed ^ (mixed >> 31)) >> 11) * 0x1p-53;
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
      // Drawn for every frame, so that one seed loses the same ones whatever else is asked for.
      const double drawn = uniform_(random_);
      const double repeat = uniform_(random_);
      const double first = uniform_(random_);
      const double second = uniform_(random_);
      const double lose = impairment_.whole ? datagram_number(frame, static_cast<std::size_t>(size),
                                                              impairment_.seed, drawn)
                                            : drawn;
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
