// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "pose/graph/record_store.hpp"

namespace orchard::mapping {

using pose::ChunkAllocator;
using pose::HeapChunkAllocator;

/// An append-only array whose rows are stored in chunks of a ChunkAllocator.
template <class Row>
class ChunkedArray {
  static_assert(std::is_trivially_copyable_v<Row>);

 public:
  explicit ChunkedArray(std::shared_ptr<ChunkAllocator> memory) : memory_(std::move(memory)) {}
  ~ChunkedArray() { clear(); }
  ChunkedArray(ChunkedArray&& other) noexcept
      : memory_(other.memory_),
        chunks_(std::exchange(other.chunks_, {})),
        size_(std::exchange(other.size_, 0)) {}
  ChunkedArray& operator=(ChunkedArray&& other) noexcept {
    if (this == &other) return *this;
    clear();
    memory_ = other.memory_;
    chunks_ = std::exchange(other.chunks_, {});
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const Row& operator[](std::size_t i) const { return used(i >> kShift)[i & kMask]; }
  const Row& back() const { return (*this)[size_ - 1]; }

  /// Returns a row for modification.
  Row& edit(std::size_t i) { return used(i >> kShift)[i & kMask]; }

  void push_back(const Row& row) {
    if (size_ >> kShift == chunks_.size()) {
      chunks_.reserve(chunks_.size() + 1);
      chunks_.push_back({static_cast<Row*>(memory_->allocate()), 0});
    }
    ::new (static_cast<void*>(&used(chunks_.size() - 1)[size_ & kMask])) Row(row);
    ++size_;
  }

  /// The contiguous rows from `i` on: pointer and number, at least one.
  std::pair<const Row*, std::size_t> run_from(std::size_t i) const {
    const std::size_t in_chunk = (kMask + 1) - (i & kMask);
    return {&(*this)[i], in_chunk < size_ - i ? in_chunk : size_ - i};
  }

  void clear() {
    for (const Chunk& chunk : chunks_) memory_->release(chunk.rows);
    chunks_.clear();
    size_ = 0;
  }

 private:
  struct Chunk {
    Row* rows = nullptr;
    mutable std::uint32_t used_in_round = 0;  ///< ChunkAllocator::round()
  };

  /// The rows of a chunk, announced to the memory.
  Row* used(std::size_t i) const {
    const Chunk& chunk = chunks_[i];
    if (chunk.used_in_round != memory_->round()) {
      memory_->use(chunk.rows);
      chunk.used_in_round = memory_->round();
    }
    return chunk.rows;
  }

  static constexpr std::size_t shift() {
    std::size_t shift = 0;
    while ((sizeof(Row) << (shift + 1)) <= ChunkAllocator::kChunkBytes) ++shift;
    return shift;
  }
  // derived: from the size of a row
  static constexpr std::size_t kShift = shift();
  static constexpr std::size_t kMask = (std::size_t{1} << kShift) - 1;

  std::shared_ptr<ChunkAllocator> memory_;
  std::vector<Chunk> chunks_;
  std::size_t size_ = 0;
};

}  // namespace orchard::mapping
