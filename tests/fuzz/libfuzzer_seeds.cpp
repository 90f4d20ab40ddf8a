// SPDX-License-Identifier: BSD-3-Clause
//
// Puts a target's good inputs into the corpus folder given on libFuzzer's command line.
#include <filesystem>
#include <fstream>

#include "fuzz/fuzz_seeds.hpp"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  for (int i = 1; i < *argc; ++i) {
    const std::filesystem::path folder((*argv)[i]);
    if ((*argv)[i][0] == '-' || !std::filesystem::is_directory(folder)) continue;
    int number = 0;
    for (const std::string& seed : orchard::fuzz::seeds()) {
      std::ofstream(folder / ("seed-" + std::to_string(number++)), std::ios::binary) << seed;
    }
    break;
  }
  return 0;
}
