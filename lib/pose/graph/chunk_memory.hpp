// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>

namespace orchard::pose {

/// Gives memory in chunks of one size, for what is written once and seldom read again.
class ChunkMemory {
 public:
  static constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

  virtual ~ChunkMemory() = default;

  /// kChunkBytes, aligned for every type, of any content. Throws std::bad_alloc.
  virtual void* take() = 0;
  virtual void give_back(void* chunk) noexcept = 0;
  /// Nothing of it is needed for the moment: it may leave for where it comes back from when read.
  virtual void rest() noexcept {}

  /// A number by which find() gives the chunk again, also in a later process; negative for memory
  /// that does not outlive this one. Whoever asks leaves the chunk as it is from then on.
  virtual std::int64_t keep(void* /*chunk*/) { return -1; }
  /// The chunk of that number; none where there is none.
  virtual void* find(std::int64_t /*number*/) { return nullptr; }
};

/// The heap.
class HeapMemory : public ChunkMemory {
 public:
  void* take() override { return ::operator new(kChunkBytes); }
  void give_back(void* chunk) noexcept override { ::operator delete(chunk); }
};

}  // namespace orchard::pose
