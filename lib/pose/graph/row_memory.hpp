// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "pose/graph/chunk_memory.hpp"

namespace orchard::pose {

/// Storage of immutable rows in chunks.
template <class Row>
class RowMemory {
  static_assert(std::is_trivially_destructible_v<Row>);

 public:
  explicit RowMemory(std::shared_ptr<ChunkMemory> memory) : memory_(std::move(memory)) {}
  ~RowMemory() {
    for (Row* chunk : chunks_) memory_->give_back(chunk);
  }
  RowMemory(const RowMemory&) = delete;
  RowMemory& operator=(const RowMemory&) = delete;

  /// Stores a contiguous copy of these rows, which lives unchanged as long as this object; null if
  /// they do not fit into one chunk.
  const Row* keep(const std::vector<Row>& rows) {
    if (rows.size() > kRowsPerChunk) return nullptr;
    if (chunks_.empty() || num_in_last_ + rows.size() > kRowsPerChunk) {
      chunks_.reserve(chunks_.size() + 1);
      chunks_.push_back(static_cast<Row*>(memory_->take()));
      num_in_last_ = 0;
    }
    Row* const at = chunks_.back() + num_in_last_;
    std::uninitialized_copy(rows.begin(), rows.end(), at);
    num_in_last_ += rows.size();
    return at;
  }

  /// Allows the memory to be paged out until it is read again.
  void rest() const { memory_->rest(); }

 private:
  static constexpr std::size_t kRowsPerChunk = ChunkMemory::kChunkBytes / sizeof(Row);

  std::shared_ptr<ChunkMemory> memory_;
  std::vector<Row*> chunks_;
  std::size_t num_in_last_ = 0;
};

}  // namespace orchard::pose
