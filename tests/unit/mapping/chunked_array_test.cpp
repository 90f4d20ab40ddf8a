// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/store/chunked_array.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
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

}  // namespace
}  // namespace orchard::mapping
