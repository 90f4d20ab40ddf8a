// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/log_player_loss.hpp"

#include <signal.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <lcm/lcm-cpp.hpp>
#include <stdexcept>
#include <thread>

namespace orchard::bench {
namespace {

constexpr const char* kCounterFlag = "--count-messages";

volatile sig_atomic_t stop_asked = 0;

struct Counter {
  void count(const lcm::ReceiveBuffer*, const std::string&) { ++num_received; }
  long long num_received = 0;
};

/// The number after a word in the counter's output so far, or -1.
std::int64_t number_after(const std::string& path, const std::string& word) {
  std::ifstream file(path);
  std::string found;
  std::int64_t number = 0;
  while (file >> found >> number) {
    if (found == word) return number;
  }
  return -1;
}

}  // namespace

std::int64_t count_played(const std::string& log_path, const std::string& lcm_url,
                          int queue_capacity, const TemporaryFolder& folder) {
  const std::string output = folder.path("counter");
  ChildProcess counter({this_program(), kCounterFlag, lcm_url, std::to_string(queue_capacity)},
                       output);
  for (int i = 0; number_after(output, "ready") < 0; ++i) {
    if (i == 1000) throw std::runtime_error("the counting subscriber does not start");
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ChildProcess player({"lcm-logplayer", "--speed=0", "--lcm-url=" + lcm_url, log_path},
                      folder.path("lcm-logplayer"));
  if (player.wait() != 0) throw std::runtime_error("lcm-logplayer failed");
  counter.stop();
  return number_after(output, "received");
}

bool is_counter(int argc, char** argv) {
  return argc == 4 && std::strcmp(argv[1], kCounterFlag) == 0;
}

int run_counter(char** argv) {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = 1; };
  sigaction(SIGINT, &action, nullptr);
  lcm::LCM lcm(argv[2]);
  if (!lcm.good()) return 1;
  Counter counter;
  lcm.subscribe(".*", &Counter::count, &counter)->setQueueCapacity(std::atoi(argv[3]));
  std::printf("ready 1\n");
  std::fflush(stdout);
  while (stop_asked == 0) lcm.handleTimeout(50);
  // What LCM's own thread still holds counts as well.
  while (lcm.handleTimeout(300) > 0) {
  }
  std::printf("received %lld\n", counter.num_received);
  return 0;
}

}  // namespace orchard::bench
