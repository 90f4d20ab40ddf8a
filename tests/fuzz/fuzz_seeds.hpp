// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

/// What libFuzzer calls with every input.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace orchard::fuzz {

/// Good inputs of a fuzz target, from which the standalone mutator starts. Each target defines it.
std::vector<std::string> seeds();

}  // namespace orchard::fuzz
