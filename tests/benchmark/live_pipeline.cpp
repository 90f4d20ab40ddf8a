// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/live_pipeline.hpp"

#include <chrono>
#include <set>
#include <stdexcept>

#include "bus/bus.hpp"

namespace orchard::bench {

std::vector<ChildProcess> start_live_pipeline(const std::string& config_path,
                                              const std::string& lcm_url,
                                              const TemporaryFolder& folder) {
  const std::set<std::string> names{"orchard-detector", "orchard-pose", "orchard-mapper"};
  std::set<std::string> missing = names;
  bus::Bus bus(lcm_url);
  bus.subscribe_status([&missing](const bus::Status& heard) { missing.erase(heard.name); });
  std::vector<ChildProcess> processes;
  for (const std::string& name : names) {
    std::vector<std::string> arguments{built_program(name), "--config", config_path, "--lcm-url",
                                       lcm_url};
    if (name == "orchard-mapper") {
      arguments.insert(arguments.end(), {"--out", folder.path("map")});
    }
    processes.emplace_back(arguments, folder.path(name + ".log"));
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!missing.empty()) {
    if (std::chrono::steady_clock::now() > end) {
      throw std::runtime_error(*missing.begin() + " was not heard on the bus");
    }
    bus.handle(100);
  }
  return processes;
}

}  // namespace orchard::bench
