// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/resource.h>

#include <cstdint>

namespace orchard::io {

/// Limits the growth of the process by that many bytes during its lifetime: a larger allocation
/// throws std::bad_alloc. For single-threaded programs; has no effect under sanitizers, which
/// reserve all address space.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t more_bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  bool active_ = false;
  rlimit before_{};
};

}  // namespace orchard::io
