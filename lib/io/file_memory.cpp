// SPDX-License-Identifier: BSD-3-Clause
#include "io/file_memory.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <new>
#include <system_error>

namespace orchard::io {
namespace {

/// Chunks that stay in memory when the next one is given.
constexpr std::size_t kWarm = 3;

/// What is left of the disk for files that somebody reads.
constexpr std::uintmax_t kLeft_bytes = 64u << 20;

}  // namespace

FileMemory::~FileMemory() {
  for (void* chunk : mapped_) ::munmap(chunk, kChunkBytes);
  if (fd_ >= 0) ::close(fd_);
}

bool FileMemory::is_of_file(void* chunk) const {
  return std::binary_search(mapped_.begin(), mapped_.end(), chunk, std::less<>());
}

/// The next part of the file; none where there is no room, which must show here and not when it is
/// written to.
void* FileMemory::map_next() noexcept {
  if (fd_ < 0 && !is_refused_) {
    fd_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    is_refused_ = fd_ < 0;
  }
  if (fd_ < 0) return nullptr;
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder_, error);
  if (error || space.available < kLeft_bytes) return nullptr;
  const auto offset = static_cast<off_t>(file_bytes_);
  if (::posix_fallocate(fd_, offset, kChunkBytes) != 0) return nullptr;
  void* chunk = ::mmap(nullptr, kChunkBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, offset);
  if (chunk == MAP_FAILED) return nullptr;
  file_bytes_ += kChunkBytes;
  mapped_.insert(std::upper_bound(mapped_.begin(), mapped_.end(), chunk, std::less<>()), chunk);
  return chunk;
}

void* FileMemory::take() {
  void* chunk = nullptr;
  if (!unused_.empty()) {
    chunk = unused_.back();
    unused_.pop_back();
  } else {
    chunk = map_next();
  }
  if (chunk == nullptr) {
    ++num_on_heap_;
    return ::operator new(kChunkBytes);
  }
  // Whatever was read since the last time leaves memory, too; the file keeps it.
  warm_.push_back(chunk);
  if (warm_.size() > kWarm) warm_.pop_front();
  for (void* other : mapped_) {
    if (std::count(warm_.begin(), warm_.end(), other) == 0) {
      ::madvise(other, kChunkBytes, MADV_DONTNEED);
    }
  }
  return chunk;
}

void FileMemory::give_back(void* chunk) noexcept {
  if (!is_of_file(chunk)) {
    ::operator delete(chunk);
    return;
  }
  unused_.push_back(chunk);
}

}  // namespace orchard::io
