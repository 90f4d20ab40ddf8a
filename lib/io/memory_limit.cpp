// SPDX-License-Identifier: BSD-3-Clause
#include "io/memory_limit.hpp"

#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace orchard::io {
namespace {

constexpr bool has_sanitizer() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
  return true;
#else
  return false;
#endif
#else
  return false;
#endif
}

}  // namespace

MemoryLimit::MemoryLimit(std::uint64_t more_bytes) {
  std::uint64_t num_pages = 0;
  std::ifstream("/proc/self/statm") >> num_pages;
  if (has_sanitizer() || num_pages == 0 || ::getrlimit(RLIMIT_AS, &before_) != 0) return;
  rlimit limit = before_;
  const std::uint64_t used = num_pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  limit.rlim_cur =
      static_cast<rlim_t>(std::min<std::uint64_t>(before_.rlim_cur, used + more_bytes));
  active_ = ::setrlimit(RLIMIT_AS, &limit) == 0;
}

MemoryLimit::~MemoryLimit() {
  if (active_) ::setrlimit(RLIMIT_AS, &before_);
}

}  // namespace orchard::io
