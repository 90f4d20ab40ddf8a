// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>

namespace orchard::pose {

/// Allocator of chunks of one size, for data that is written once and seldom read.
///
/// A memory in a file keeps only a few chunks loaded. It learns from use() which ones are: a caller
/// notes round() when it calls use() for a chunk, and calls use() again when round() has changed.
/// Pointers into a chunk stay valid; a missing call costs memory, not correctness.
class ChunkAllocator {
 public:
  static constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

  virtual ~ChunkAllocator() = default;

  /// Allocates kChunkBytes, aligned for every type, uninitialised. Throws std::bad_alloc.
  virtual void* allocate() = 0;
  virtual void release(void* chunk) noexcept = 0;

  /// Announces that a chunk is going to be read or written.
  virtual void use(void* /*chunk*/) {}
  /// Number of times that chunks were unloaded, plus one.
  std::uint32_t round() const { return round_; }

 protected:
  std::uint32_t round_ = 1;
};

/// Chunk memory on the heap.
class HeapChunkAllocator : public ChunkAllocator {
 public:
  void* allocate() override { return ::operator new(kChunkBytes); }
  void release(void* chunk) noexcept override { ::operator delete(chunk); }
};

}  // namespace orchard::pose
