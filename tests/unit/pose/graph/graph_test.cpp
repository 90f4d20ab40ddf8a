// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/graph.hpp"

#include <gtest/gtest.h>

#include <malloc.h>
#include <sys/mman.h>

#include <memory>

namespace orchard::pose {
namespace {

ObservationList list_of(int num, int first) {
  ObservationList list;
  for (int i = 0; i < num; ++i) {
    SlamObservation o;
    o.landmark = first + i;
    o.information_m = {0.5 * i, 1.0 / 3.0};
    list.edit().push_back(o);
  }
  return list;
}

void expect_list(const ObservationList& list, int num, int first) {
  ASSERT_EQ(list.size(), static_cast<std::size_t>(num));
  for (int i = 0; i < num; ++i) {
    EXPECT_EQ(list[static_cast<std::size_t>(i)].landmark, first + i);
    EXPECT_EQ(list[static_cast<std::size_t>(i)].information_m, Eigen::Vector2d(0.5 * i, 1.0 / 3.0));
  }
}

TEST(ObservationList, ReadsTheSameWhereverItLies) {
  SlamObservationStore memory(std::make_shared<HeapChunkAllocator>());
  std::vector<ObservationList> lists;
  for (int k = 0; k < 500; ++k) lists.push_back(list_of(k % 120, k));  // some megabytes
  for (ObservationList& list : lists) list.keep(memory);
  for (int k = 0; k < 500; ++k) expect_list(lists[static_cast<std::size_t>(k)], k % 120, k);
}

/// Chunks that are not the heap's.
class MappedMemory : public ChunkAllocator {
 public:
  void* allocate() override {
    return ::mmap(nullptr, kChunkBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  }
  void release(void* chunk) noexcept override { ::munmap(chunk, kChunkBytes); }
};

TEST(ObservationList, WhatLiesInMemoryHasLeftTheHeap) {
  SlamObservationStore memory(std::make_shared<MappedMemory>());
  std::vector<ObservationList> lists;
  for (int k = 0; k < 500; ++k) lists.push_back(list_of(100, k));
  const std::size_t before = ::mallinfo2().uordblks;
  for (ObservationList& list : lists) list.keep(memory);
  const std::size_t after = ::mallinfo2().uordblks;
  if (before == 0) GTEST_SKIP() << "the heap tells nothing";
  EXPECT_LT(after + 4'000'000, before);
}

TEST(ObservationList, AChangeLeavesCopiesAsTheyWere) {
  SlamObservationStore memory(std::make_shared<HeapChunkAllocator>());
  ObservationList list = list_of(20, 7);
  list.keep(memory);
  const ObservationList before = list;
  list.edit().erase(list.edit().begin());
  expect_list(before, 20, 7);
  ASSERT_EQ(list.size(), 19u);
  EXPECT_EQ(list[0].landmark, 8);
  list.keep(memory);
  EXPECT_EQ(list[18].landmark, 26);
  expect_list(before, 20, 7);
}

TEST(ObservationList, WhatFitsNoChunkStaysOnTheHeap) {
  SlamObservationStore memory(std::make_shared<HeapChunkAllocator>());
  ObservationList list = list_of(40'000, 0);
  list.keep(memory);
  expect_list(list, 40'000, 0);
}

}  // namespace
}  // namespace orchard::pose
