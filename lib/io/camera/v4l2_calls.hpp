// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace orchard::io {

/// System calls used for a camera; replaced by a fake in tests. Errors are negative errno values.
class V4l2Calls {
 public:
  virtual ~V4l2Calls() = default;
  virtual int open(const std::string& path) = 0;
  virtual void close(int fileno) = 0;
  virtual int ioctl(int fileno, unsigned long request, void* argument) = 0;
  virtual void* map(int fileno, std::size_t size, std::int64_t offset) = 0;  ///< null on failure
  virtual void unmap(void* memory, std::size_t size) = 0;
  virtual std::int64_t monotonic_us() = 0;
  virtual std::int64_t time_of_day_us() = 0;
};

/// Returns the real system calls.
std::unique_ptr<V4l2Calls> make_v4l2_calls();

}  // namespace orchard::io
