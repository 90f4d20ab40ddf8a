// SPDX-License-Identifier: BSD-3-Clause
//
// Any text is a configuration or a ConfigError; and what was read prints and reads back the same.
#include <cstdlib>

#include "fuzz/fuzz_seeds.hpp"
#include "io/config/config.hpp"

using namespace orchard;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const io::Config config = io::parse_config(text, "fuzz.yaml");
    const std::string effective = io::effective_config(config);
    if (io::effective_config(io::parse_config(effective, "again.yaml")) != effective) std::abort();
  } catch (const io::ConfigError&) {
  }
  return 0;
}

namespace orchard::fuzz {

std::vector<std::string> seeds() {
  return {"", io::print_config(io::Config{}), io::effective_config(io::Config{}),
          "detector:\n  tree_threshold: 0.5\ncamera: {enabled: false, fc_px: [200, 201.5]}\n",
          "lcm: {url: \"memq://\"}\npose:\n  mode: fixes\n"};
}

}  // namespace orchard::fuzz
