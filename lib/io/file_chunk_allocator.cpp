// SPDX-License-Identifier: BSD-3-Clause
#include "io/file_chunk_allocator.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <new>
#include <system_error>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

/// Disk space left free for the output files.
constexpr std::uintmax_t kLeft_bytes = 64u << 20;

std::uint32_t crc_of(const void* chunk) {
  return static_cast<std::uint32_t>(
      ::crc32_z(0, static_cast<const Bytef*>(chunk), mapping::ChunkAllocator::kChunkBytes));
}

bool is_before(const PersistentChunk& chunk, std::uint32_t number) { return chunk.number < number; }

bool contains(const std::vector<PersistentChunk>& chunks, std::uint32_t number) {
  const auto at = std::lower_bound(chunks.begin(), chunks.end(), number, is_before);
  return at != chunks.end() && at->number == number;
}

}  // namespace

FileChunkAllocator::~FileChunkAllocator() {
  for (const Mapped& chunk : mapped_) ::munmap(chunk.first, kChunkBytes);
  if (fd_ >= 0) ::close(fd_);
}

const FileChunkAllocator::Mapped* FileChunkAllocator::mapped(const void* chunk) const {
  const auto at = std::lower_bound(
      mapped_.begin(), mapped_.end(), chunk,
      [](const Mapped& one, const void* other) { return std::less<>()(one.first, other); });
  return at != mapped_.end() && at->first == chunk ? &*at : nullptr;
}

bool FileChunkAllocator::open_file(bool anew) noexcept {
  if (fd_ >= 0) return true;
  if (is_refused_) return false;
  if (name_.empty()) {
    fd_ = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  } else {
    const std::string path = folder_ + "/" + name_;
    fd_ = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | (anew ? O_CREAT | O_TRUNC : 0),
                 0666);
  }
  is_refused_ = fd_ < 0;
  return fd_ >= 0;
}

/// Maps a chunk of the file, which must be long enough; null if no address space is left.
void* FileChunkAllocator::map(std::uint32_t number) noexcept {
  void* chunk = ::mmap(nullptr, kChunkBytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd_,
                       static_cast<off_t>(number) * static_cast<off_t>(kChunkBytes));
  if (chunk == MAP_FAILED) return nullptr;
  const Mapped entry{chunk, number};
  mapped_.insert(std::upper_bound(mapped_.begin(), mapped_.end(), entry,
                                  [](const Mapped& a, const Mapped& b) {
                                    return std::less<>()(a.first, b.first);
                                  }),
                 entry);
  return chunk;
}

/// Extends the file by one chunk and maps it; null if there is no space, which must be detected
/// here and not when the chunk is written to.
void* FileChunkAllocator::map_next() noexcept {
  if (!open_file(true)) return nullptr;
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder_, error);
  if (error || space.available < kLeft_bytes) return nullptr;
  const auto offset = static_cast<off_t>(num_in_file_) * static_cast<off_t>(kChunkBytes);
  if (::posix_fallocate(fd_, offset, kChunkBytes) != 0) return nullptr;
  void* chunk = map(num_in_file_);
  if (chunk != nullptr) ++num_in_file_;
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
  if (mapped(chunk) == nullptr) return;  // on the heap, where unloading would lose the data
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
  const Mapped* at = mapped(chunk);
  if (at == nullptr) {
    ::operator delete(chunk);
    return;
  }
  (contains(kept_, at->second) ? released_ : unused_).push_back(chunk);
}

std::int64_t FileChunkAllocator::keep(void* chunk) {
  const Mapped* at = name_.empty() ? nullptr : mapped(chunk);
  if (at == nullptr) return -1;
  to_keep_.insert(at->second);
  return at->second;
}

void* FileChunkAllocator::find(std::int64_t number) {
  for (const Mapped& chunk : mapped_) {
    if (chunk.second == number) return chunk.first;
  }
  return nullptr;
}

std::vector<PersistentChunk> FileChunkAllocator::sync_persistent() {
  std::vector<PersistentChunk> now;
  for (const Mapped& chunk : mapped_) {
    if (to_keep_.count(chunk.second) == 0) continue;
    const auto then = std::lower_bound(kept_.begin(), kept_.end(), chunk.second, is_before);
    const bool is_known = then != kept_.end() && then->number == chunk.second;
    if (!is_known) use(chunk.first);
    now.push_back({chunk.second, is_known ? then->crc : crc_of(chunk.first)});
  }
  to_keep_.clear();
  if (fd_ >= 0 && ::fdatasync(fd_) != 0) {
    throw FileError(folder_ + "/" + name_ + ": cannot be synced to the disk (" +
                    std::strerror(errno) + ")");
  }
  std::sort(now.begin(), now.end(),
            [](const PersistentChunk& a, const PersistentChunk& b) { return a.number < b.number; });
  written_ = now;
  return now;
}

void FileChunkAllocator::release_others() {
  kept_ = written_;
  const auto is_free = [this](void* chunk) { return !contains(kept_, mapped(chunk)->second); };
  for (void* chunk : released_) {
    if (is_free(chunk)) unused_.push_back(chunk);
  }
  released_.erase(std::remove_if(released_.begin(), released_.end(), is_free), released_.end());
}

bool FileChunkAllocator::restore(const std::vector<PersistentChunk>& chunks) {
  if (chunks.empty()) return true;
  struct stat status {};
  if (!open_file(false) || ::fstat(fd_, &status) != 0 || !S_ISREG(status.st_mode)) return false;
  const std::int64_t num_in_file = status.st_size / static_cast<std::int64_t>(kChunkBytes);
  num_in_file_ = static_cast<std::uint32_t>(std::min<std::int64_t>(num_in_file, UINT32_MAX));
  for (std::uint32_t number = 0; number < num_in_file_; ++number) {
    void* chunk = map(number);
    if (chunk == nullptr) return false;
    const auto at = std::lower_bound(chunks.begin(), chunks.end(), number, is_before);
    if (at == chunks.end() || at->number != number) {
      unused_.push_back(chunk);
      continue;
    }
    use(chunk);
    if (crc_of(chunk) != at->crc) return false;
  }
  kept_ = written_ = chunks;
  return chunks.back().number < num_in_file_;
}

}  // namespace orchard::io
