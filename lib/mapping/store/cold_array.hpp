// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "mapping/store/chunk_memory.hpp"

namespace orchard::mapping {

/// An array that grows at its end, in chunks that never move.
template <class Row>
class ColdArray {
  static_assert(std::is_trivially_copyable_v<Row>);

 public:
  explicit ColdArray(std::shared_ptr<ChunkMemory> memory) : memory_(std::move(memory)) {}
  ~ColdArray() { clear(); }
  ColdArray(ColdArray&& other) noexcept
      : memory_(other.memory_),
        chunks_(std::exchange(other.chunks_, {})),
        size_(std::exchange(other.size_, 0)) {}
  ColdArray& operator=(ColdArray&& other) noexcept {
    if (this == &other) return *this;
    clear();
    memory_ = other.memory_;
    chunks_ = std::exchange(other.chunks_, {});
    size_ = std::exchange(other.size_, 0);
    return *this;
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const Row& operator[](std::size_t i) const { return chunks_[i >> kShift][i & kMask]; }
  Row& operator[](std::size_t i) { return chunks_[i >> kShift][i & kMask]; }
  const Row& back() const { return (*this)[size_ - 1]; }
  Row& back() { return (*this)[size_ - 1]; }

  void push_back(const Row& row) {
    if (size_ >> kShift == chunks_.size()) {
      chunks_.reserve(chunks_.size() + 1);
      chunks_.push_back(static_cast<Row*>(memory_->take()));
    }
    ::new (static_cast<void*>(&chunks_.back()[size_ & kMask])) Row(row);
    ++size_;
  }

  /// Rows that stand together without a break, from `i` on: at least one, up to the end.
  std::pair<const Row*, std::size_t> run_from(std::size_t i) const {
    const std::size_t in_chunk = (kMask + 1) - (i & kMask);
    return {&(*this)[i], in_chunk < size_ - i ? in_chunk : size_ - i};
  }

  void clear() {
    for (Row* chunk : chunks_) memory_->give_back(chunk);
    chunks_.clear();
    size_ = 0;
  }

 private:
  static constexpr std::size_t shift() {
    std::size_t shift = 0;
    while ((sizeof(Row) << (shift + 1)) <= ChunkMemory::kChunkBytes) ++shift;
    return shift;
  }
  static constexpr std::size_t kShift = shift();
  static constexpr std::size_t kMask = (std::size_t{1} << kShift) - 1;

  std::shared_ptr<ChunkMemory> memory_;
  std::vector<Row*> chunks_;
  std::size_t size_ = 0;
};

}  // namespace orchard::mapping
