// SPDX-License-Identifier: BSD-3-Clause
#include <malloc.h>

#include "cli/command_line.hpp"

namespace {

/// Larger blocks go back to the system when they are freed. As it comes, glibc keeps the more of
/// them the larger they were, a third of the memory of a map of 100,000 trees.
constexpr int kReturned_bytes = 1 << 20;

}  // namespace

int main(int argc, char** argv) {
  ::mallopt(M_MMAP_THRESHOLD, kReturned_bytes);
  return orchard::cli::run_command_line(argc, argv);
}
