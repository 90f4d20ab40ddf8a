// SPDX-License-Identifier: BSD-3-Clause
// status_watch URL NAME MIN_BAD [TEXT]: waits (at most a minute) for a STATUS of a process that
// counts at least so many refused messages and says TEXT; prints it.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "bus/bus.hpp"

int main(int argc, char** argv) {
  if (argc != 4 && argc != 5) return 2;
  using namespace orchard::bus;
  Bus bus(argv[1]);
  bool found = false;
  bus.subscribe_status([&](const Status& status) {
    if (status.name != argv[2] || status.num_bad < std::atoll(argv[3])) return;
    if (argc == 5 && status.text.find(argv[4]) == std::string::npos) return;
    std::printf("%s good %lld bad %lld: %s\n", status.name.c_str(),
                static_cast<long long>(status.num_good), static_cast<long long>(status.num_bad),
                status.text.c_str());
    found = true;
  });
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!found && std::chrono::steady_clock::now() < end) bus.handle(200);
  return found ? 0 : 1;
}
