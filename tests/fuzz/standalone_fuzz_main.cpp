// SPDX-License-Identifier: BSD-3-Clause
//
// A small mutator for builds without libFuzzer: usage: fuzz_x [RUNS [SECONDS [SEED]]]. Stops after
// RUNS inputs or SECONDS, whichever comes first. Which inputs it makes depends on SEED alone. On a
// crash the input is in fuzz_x.crash; fuzz_x FILE runs that input again.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "fuzz/fuzz_seeds.hpp"

namespace {

std::string crash_path;
std::string current_input;

/// An upper bound that keeps single runs short.
constexpr std::size_t kMaxInputBytes = 1u << 14;

std::size_t below(std::mt19937_64& random, std::size_t bound) {
  return bound == 0 ? 0 : static_cast<std::size_t>(random() % bound);
}

void mutate(std::mt19937_64& random, const std::vector<std::string>& seeds, std::string& input) {
  static const std::string kExtremes[] = {std::string("\x7F\xFF\xFF\xFF", 4),
                                          std::string("\x80\x00\x00\x00", 4),
                                          std::string("\xFF\xFF\xFF\xFF", 4),
                                          std::string("\x00\x00\x00\x00", 4),
                                          "-1",
                                          "nan",
                                          "inf",
                                          "1e999",
                                          "9223372036854775808",
                                          ",",
                                          "\n",
                                          "\r",
                                          "\"",
                                          "[",
                                          "{",
                                          ": "};
  const std::size_t at = below(random, input.size() + 1);
  const std::size_t count = below(random, std::min<std::size_t>(input.size() - at, 32) + 1);
  switch (below(random, 8)) {
    case 0:
      if (at < input.size()) input[at] = static_cast<char>(input[at] ^ (1 << below(random, 8)));
      break;
    case 1:
      if (at < input.size()) input[at] = static_cast<char>(random());
      break;
    case 2:
      input.erase(at, count);
      break;
    case 3:
      input.insert(at, input.substr(at, count));
      break;
    case 4:
      input.resize(at);
      break;
    case 5:
      input.insert(at, kExtremes[below(random, std::size(kExtremes))]);
      break;
    case 6: {
      const std::string& extreme = kExtremes[below(random, std::size(kExtremes))];
      input.replace(at, std::min(extreme.size(), input.size() - at), extreme);
      break;
    }
    default: {
      const std::string& other = seeds[below(random, seeds.size())];
      const std::size_t from = below(random, other.size() + 1);
      input.insert(at, other.substr(from, below(random, 256)));
    }
  }
  if (input.size() > kMaxInputBytes) input.resize(kMaxInputBytes);
}

void run(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
}

/// Called when a target aborts, or an exception gets out of it: both are findings.
void save_input(int) {
  std::ofstream(crash_path, std::ios::binary) << current_input;
  std::fprintf(stderr, "the input that did it is in %s\n", crash_path.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  crash_path = std::string(argv[0]) + ".crash";
  if (argc > 1) {
    if (std::ifstream file(argv[1], std::ios::binary); file) {
      run(std::string(std::istreambuf_iterator<char>(file), {}));
      return 0;
    }
  }
  const long num_runs = argc > 1 ? std::atol(argv[1]) : 20000;
  const double max_s = argc > 2 ? std::atof(argv[2]) : 1e9;
  std::mt19937_64 random(argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1);
  std::signal(SIGABRT, save_input);
  const std::vector<std::string> seeds = orchard::fuzz::seeds();
  for (const std::string& seed : seeds) run(current_input = seed);
  const auto begin = std::chrono::steady_clock::now();
  long runs = 0;
  for (; runs < num_runs; ++runs) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    if (elapsed.count() > max_s) break;
    current_input = seeds[below(random, seeds.size())];
    for (std::size_t i = below(random, 6) + 1; i > 0; --i) mutate(random, seeds, current_input);
    run(current_input);
  }
  std::printf("%ld inputs from %zu seeds, no finding\n", runs, seeds.size());
  return 0;
}
