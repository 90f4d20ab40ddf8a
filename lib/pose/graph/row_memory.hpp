// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "pose/graph/chunk_memory.hpp"

namespace orchard::pose {

/// Where rows lie that nobody changes any more, in chunks.
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

  /// A copy of these rows, side by side, which stays as it is as long as this lives; none of too
  /// many for a chunk.
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

  /// Nothing of it is needed for the moment.
  void rest() const { memory_->rest(); }

 private:
  static constexpr std::size_t kRowsPerChunk = ChunkMemory::kChunkBytes / sizeof(Row);

  std::shared_ptr<ChunkMemory> memory_;
  std::vector<Row*> chunks_;
  std::size_t num_in_last_ = 0;
};

}  // namespace orchard::pose
