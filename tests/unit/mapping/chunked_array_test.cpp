// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/store/chunked_array.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

namespace orchard::mapping {
namespace {

struct Row {
  std::int64_t number = 0;
  char rest[4080];
};

/// The heap, which counts what is out.
class CountingMemory : public HeapChunkAllocator {
 public:
  void* allocate() override {
    void* chunk = HeapChunkAllocator::allocate();
    out.insert(chunk);
    return chunk;
  }
  void release(void* chunk) noexcept override {
    EXPECT_EQ(out.erase(chunk), 1u);
    HeapChunkAllocator::release(chunk);
  }
  std::set<void*> out;
};

TEST(ChunkedArray, HoldsItsRowsInChunksAndGivesThemBack) {
  const auto memory = std::make_shared<CountingMemory>();
  {
    ChunkedArray<Row> rows(memory);
    EXPECT_TRUE(rows.empty());
    EXPECT_TRUE(memory->out.empty()) << "an empty one needs none";
    for (int k = 0; k < 1000; ++k) {
      Row row{};
      row.number = 7 * k;
      rows.push_back(row);
    }
    EXPECT_EQ(rows.size(), 1000u);
    EXPECT_EQ(memory->out.size(), 4u);  // 256 rows to a megabyte
    rows.edit(500).number = -1;
    for (int k = 0; k < 1000; ++k) {
      EXPECT_EQ(rows[static_cast<std::size_t>(k)].number, k == 500 ? -1 : 7 * k);
    }
    ChunkedArray<Row> moved(std::move(rows));
    EXPECT_EQ(moved.back().number, 7 * 999);
    ChunkedArray<Row> other(memory);
    other.push_back({});
    other = std::move(moved);
    EXPECT_EQ(other.size(), 1000u);
    EXPECT_EQ(memory->out.size(), 4u);
  }
  EXPECT_TRUE(memory->out.empty());
}

/// The heap, which keeps what it is asked to.
class KeepingMemory : public HeapChunkAllocator {
 public:
  ~KeepingMemory() override {
    for (void* chunk : kept) HeapChunkAllocator::release(chunk);
  }
  void release(void* chunk) noexcept override {
    if (std::find(kept.begin(), kept.end(), chunk) == kept.end())
      HeapChunkAllocator::release(chunk);
  }
  std::int64_t keep(void* chunk) override {
    kept.push_back(chunk);
    return static_cast<std::int64_t>(kept.size()) - 1;
  }
  void* find(std::int64_t number) override { return kept.at(static_cast<std::size_t>(number)); }
  std::vector<void*> kept;
};

TEST(ChunkedArray, WhatWasKeptStaysWhenItIsChanged) {
  const auto memory = std::make_shared<KeepingMemory>();
  ChunkedArray<Row> rows(memory);
  for (int k = 0; k < 300; ++k) rows.push_back({k, {}});
  StateArchive written;
  rows.persist(written);
  rows.edit(3).number = -3;
  rows.push_back(rows[299]);
  EXPECT_EQ(rows[3].number, -3);
  EXPECT_EQ(rows[4].number, 4);
  EXPECT_EQ(rows[300].number, 299);
  ChunkedArray<Row> then(memory);
  StateArchive read(written.bytes());
  then.persist(read);
  EXPECT_EQ(read.num_left(), 0u);
  ASSERT_EQ(then.size(), 300u);
  EXPECT_EQ(then[3].number, 3) << "as it was kept";
  EXPECT_EQ(then[299].number, 299);
}

TEST(ChunkedArray, AMemoryThatKeepsNothingSaysSo) {
  ChunkedArray<Row> rows(std::make_shared<HeapChunkAllocator>());
  rows.push_back({});
  StateArchive state;
  EXPECT_THROW(rows.persist(state), std::runtime_error);
}

}  // namespace
}  // namespace orchard::mapping
