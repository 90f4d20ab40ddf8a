// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "mapping/store/chunk_allocator.hpp"
#include "mapping/store/state_archive.hpp"

namespace orchard::mapping {

/// An append-only array whose rows are stored in chunks of a ChunkAllocator. Chunks kept by
/// persist() are never changed: the first edit of one of their rows copies the chunk.
template <class Row>
class ChunkedArray {
  static_assert(std::is_trivially_copyable_v<Row>);

 public:
  explicit ChunkedArray(std::shared_ptr<ChunkAllocator> memory) : memory_(std::move(memory)) {}
  ~ChunkedArray() { clear(); }
  ChunkedArray(ChunkedArray&& other) noexcept
      : memory_(other.memory_),
        chunks_(std::exchange(other.chunks_, {})),
        is_kept_(std::exchange(other.is_kept_, {})),
        used_in_round_(std::exchange(other.used_in_round_, {})),
        size_(std::exchange(other.size_, 0)) {}
  ChunkedArray& operator=(ChunkedArray&& other) noexcept {
    if (this == &other) return *this;
    clear();
    memory_ = other.memory_;
    chunks_ = std::exchange(other.chunks_, {});
    is_kept_ = std::exchange(other.is_kept_, {});
    used_in_round_ = std::exchange(other.used_in_round_, {});
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const Row& operator[](std::size_t i) const { return used(i >> kShift)[i & kMask]; }
  const Row& back() const { return (*this)[size_ - 1]; }

  /// Returns a row for modification. Invalidates references to rows of the same chunk.
  Row& edit(std::size_t i) {
    const std::size_t chunk = i >> kShift;
    if (is_kept_[chunk] != 0) copy_on_write(chunk);
    return used(chunk)[i & kMask];
  }

  void push_back(const Row& row) {
    if (size_ >> kShift == chunks_.size()) {
      is_kept_.reserve(chunks_.size() + 1);
      used_in_round_.reserve(chunks_.size() + 1);
      chunks_.reserve(chunks_.size() + 1);
      chunks_.push_back(static_cast<Row*>(memory_->allocate()));
      is_kept_.push_back(0);
      used_in_round_.push_back(0);
    } else if (is_kept_.back() != 0) {
      const Row copy = row;  // `row` may be inside the chunk
      copy_on_write(chunks_.size() - 1);
      return push_back(copy);
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
    for (Row* chunk : chunks_) memory_->release(chunk);
    chunks_.clear();
    is_kept_.clear();
    used_in_round_.clear();
    size_ = 0;
  }

  /// Saves or restores the array: the chunks are kept in the memory, only their numbers are
  /// written. Throws std::runtime_error when the memory does not keep or does not find them.
  void persist(StateArchive& archive) {
    std::uint64_t size = size_;
    std::uint32_t row_size = sizeof(Row);
    archive(size, row_size);
    if (archive.is_reading()) {
      if (row_size != sizeof(Row)) throw std::length_error("state: of another program");
      clear();
    }
    const std::size_t num_chunks = (static_cast<std::size_t>(size) + kMask) >> kShift;
    for (std::size_t i = 0; i < num_chunks; ++i) {
      std::int64_t number = archive.is_reading() ? -1 : memory_->keep(chunks_[i]);
      archive(number);
      if (archive.is_reading()) {
        void* chunk = memory_->find(number);
        if (chunk != nullptr) {
          chunks_.push_back(static_cast<Row*>(chunk));
          is_kept_.push_back(1);
        }
      }
      if (number < 0 || chunks_.size() <= i) throw std::runtime_error("state: chunks not kept");
    }
    is_kept_.assign(chunks_.size(), 1);
    used_in_round_.assign(chunks_.size(), 0);
    size_ = static_cast<std::size_t>(size);
  }

 private:
  /// The rows of a chunk, announced to the memory.
  Row* used(std::size_t chunk) const {
    if (used_in_round_[chunk] != memory_->round()) {
      memory_->use(chunks_[chunk]);
      used_in_round_[chunk] = memory_->round();
    }
    return chunks_[chunk];
  }

  void copy_on_write(std::size_t chunk) {
    void* now = memory_->allocate();
    std::memcpy(now, used(chunk), (kMask + 1) * sizeof(Row));
    memory_->release(std::exchange(chunks_[chunk], static_cast<Row*>(now)));
    is_kept_[chunk] = 0;
    used_in_round_[chunk] = 0;
  }

  static constexpr std::size_t shift() {
    std::size_t shift = 0;
    while ((sizeof(Row) << (shift + 1)) <= ChunkAllocator::kChunkBytes) ++shift;
    return shift;
  }
  static constexpr std::size_t kShift = shift();
  static constexpr std::size_t kMask = (std::size_t{1} << kShift) - 1;

  std::shared_ptr<ChunkAllocator> memory_;
  std::vector<Row*> chunks_;
  std::vector<char> is_kept_;  ///< per chunk: kept, must be copied before an edit
  mutable std::vector<std::uint32_t> used_in_round_;  ///< per chunk: ChunkAllocator::round()
  std::size_t size_ = 0;
};

}  // namespace orchard::mapping
