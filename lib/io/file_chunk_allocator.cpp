// SPDX-License-Identifier: BSD-3-Clause
#include "io/file_chunk_allocator.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <new>
#include <system_error>

namespace orchard::io {
namespace {

/// Disk space left free for the output files.
constexpr std::uintmax_t kLeft_bytes = 64u << 20;

/// Opens a file without a name in a folder; negative if that fails. Some file systems (FAT, NFS)
/// only give up the name of a file that has one.
int open_nameless(const std::string& folder) {
  const int fd = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (fd >= 0) return fd;
  std::string name = folder + "/.chunks.XXXXXX";
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

}  // namespace

FileChunkAllocator::~FileChunkAllocator() {
  for (void* chunk : mapped_) ::munmap(chunk, kChunkBytes);
  if (fd_ >= 0) ::close(fd_);
}

bool FileChunkAllocator::is_mapped(const void* chunk) const {
  return std::binary_search(mapped_.begin(), mapped_.end(), chunk, std::less<>());
}

bool FileChunkAllocator::open_file() noexcept {
  if (fd_ >= 0) return true;
  if (is_refused_) return false;
  fd_ = open_nameless(folder_);
  is_refused_ = fd_ < 0;
  return fd_ >= 0;
}

/// Extends the file by one chunk and maps it; null if there is no space, which must be detected
/// here and not when the chunk is written to.
void* FileChunkAllocator::map_next() noexcept {
  if (!open_file()) return nullptr;
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder_, error);
  if (error || space.available < kLeft_bytes) return nullptr;
  const auto offset = static_cast<off_t>(mapped_.size() * kChunkBytes);
  if (::posix_fallocate(fd_, offset, kChunkBytes) != 0) return nullptr;
  void* chunk = ::mmap(nullptr, kChunkBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, offset);
  if (chunk == MAP_FAILED) return nullptr;
  mapped_.insert(std::upper_bound(mapped_.begin(), mapped_.end(), chunk, std::less<>()), chunk);
  return chunk;
}

void* FileChunkAllocator::allocate() {
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
  return chunk;
}

void FileChunkAllocator::use(void* chunk) {
  if (!is_mapped(chunk)) return;  // on the heap, where unloading would lose the data
  if (loaded_.size() >= loaded_max_) unload();
  loaded_.push_back(chunk);
}

/// Removes the chunks of this round from memory; the file keeps them.
void FileChunkAllocator::unload() noexcept {
  for (void* chunk : loaded_) ::madvise(chunk, kChunkBytes, MADV_DONTNEED);
  loaded_.clear();
  ++round_;
}

void FileChunkAllocator::release(void* chunk) noexcept {
  if (is_mapped(chunk)) {
    unused_.push_back(chunk);
  } else {
    ::operator delete(chunk);
  }
}

}  // namespace orchard::io
