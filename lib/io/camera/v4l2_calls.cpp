// SPDX-License-Identifier: BSD-3-Clause
#include "io/camera/v4l2_calls.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>

namespace orchard::io {
namespace {

template <class Clock>
std::int64_t now_us() {
  return std::chrono::duration_cast<std::chrono::microseconds>(Clock::now().time_since_epoch())
      .count();
}

class KernelCalls : public V4l2Calls {
 public:
  int open(const std::string& path) override {
    const int fileno = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fileno >= 0 ? fileno : -errno;
  }
  void close(int fileno) override { ::close(fileno); }
  int ioctl(int fileno, unsigned long request, void* argument) override {
    int result = 0;
    do {
      result = ::ioctl(fileno, request, argument);
    } while (result < 0 && errno == EINTR);
    return result >= 0 ? result : -errno;
  }
  void* map(int fileno, std::size_t size, std::int64_t offset) override {
    void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, fileno, offset);
    return memory == MAP_FAILED ? nullptr : memory;
  }
  void unmap(void* memory, std::size_t size) override { munmap(memory, size); }
  // libstdc++'s steady_clock is CLOCK_MONOTONIC, the clock of V4L2's stamps.
  std::int64_t monotonic_us() override { return now_us<std::chrono::steady_clock>(); }
  std::int64_t time_of_day_us() override { return now_us<std::chrono::system_clock>(); }
};

}  // namespace

std::unique_ptr<V4l2Calls> make_v4l2_calls() { return std::make_unique<KernelCalls>(); }

}  // namespace orchard::io
