// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace orchard::pose {

/// Allocator of chunks of one size, for data that is written once and seldom read.
///
/// A memory in a file keeps only a few chunks loaded. It learns from use() which ones are: a caller
/// notes round() when it calls use() for a chunk, and calls use() again when round() has changed.
/// Pointers into a chunk stay valid; a missing call costs memory, not correctness.
class ChunkAllocator {
 public:
  static constexpr std::size_t kChunkBytes = std::size_t{1} << 20;  // derived: some 256 pages

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

/// Storage of immutable rows in chunks.
template <class Row>
class RecordStore {
  static_assert(std::is_trivially_destructible_v<Row>);

 public:
  explicit RecordStore(std::shared_ptr<ChunkAllocator> memory) : memory_(std::move(memory)) {}
  ~RecordStore() {
    for (const Chunk& chunk : chunks_) memory_->release(chunk.rows);
  }
  RecordStore(const RecordStore&) = delete;
  RecordStore& operator=(const RecordStore&) = delete;

  /// Contiguous rows in this memory.
  struct Place {
    const Row* first = nullptr;  ///< to be read after use(place)
    std::uint32_t num_rows = 0;
    std::uint32_t chunk = 0;
  };

  /// Stores a copy of these rows, which lives unchanged as long as this object; a null `first` if
  /// they do not fit into one chunk.
  Place keep(const std::vector<Row>& rows) {
    if (rows.size() > kRowsPerChunk) return {};
    if (chunks_.empty() || num_in_last_ + rows.size() > kRowsPerChunk) {
      chunks_.reserve(chunks_.size() + 1);
      chunks_.push_back({static_cast<Row*>(memory_->allocate()), 0});
      num_in_last_ = 0;
    }
    const auto chunk = static_cast<std::uint32_t>(chunks_.size() - 1);
    Row* const at = chunks_.back().rows + num_in_last_;
    const Place place{at, static_cast<std::uint32_t>(rows.size()), chunk};
    use(place);
    std::uninitialized_copy(rows.begin(), rows.end(), at);
    num_in_last_ += rows.size();
    return place;
  }

  /// Call before reading the rows of a place.
  void use(const Place& place) const {
    const Chunk& chunk = chunks_[place.chunk];
    if (chunk.used_in_round == memory_->round()) return;
    memory_->use(chunk.rows);
    chunk.used_in_round = memory_->round();
  }

 private:
  // derived: by size.
  static constexpr std::size_t kRowsPerChunk = ChunkAllocator::kChunkBytes / sizeof(Row);

  struct Chunk {
    Row* rows = nullptr;
    mutable std::uint32_t used_in_round = 0;
  };

  std::shared_ptr<ChunkAllocator> memory_;
  std::vector<Chunk> chunks_;
  std::size_t num_in_last_ = 0;
};

}  // namespace orchard::pose
