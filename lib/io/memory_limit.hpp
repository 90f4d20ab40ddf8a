// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/resource.h>

#include <cstdint>

namespace orchard::io {

/// Lets the process grow by no more than that many bytes while this object lives: an allocation
/// beyond throws std::bad_alloc. For one thread; does nothing under sanitizers, which need it all.
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
