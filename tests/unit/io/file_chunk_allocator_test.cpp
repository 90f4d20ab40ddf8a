// SPDX-License-Identifier: BSD-3-Clause
#include "io/file_chunk_allocator.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

constexpr std::size_t kBytes = FileChunkAllocator::kChunkBytes;

// A sanitizer keeps notes of its own, larger than the chunks.
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
constexpr bool kIsMemoryOwn = false;
#else
constexpr bool kIsMemoryOwn = true;
#endif

long own_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stol(line.substr(6));
  }
  return -1;
}

TEST(FileChunkAllocator, KeepsWhatIsWrittenAndLittleInMemory) {
  const TestFolder folder;
  FileChunkAllocator memory(folder.path());
  std::vector<void*> chunks;
  const long before_kb = own_kb();
  for (int k = 0; k < 200; ++k) {
    chunks.push_back(memory.allocate());
    memory.use(chunks.back());
    std::memset(chunks.back(), k, kBytes);
  }
  if (memory.num_on_heap() > 0) GTEST_SKIP() << "no file without a name can be made here";
  if (kIsMemoryOwn) {
    EXPECT_LT(own_kb() - before_kb, 70000) << "of 200 MB";
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the file has no name";
  const auto round = memory.round();
  for (int k = 0; k < 200; ++k) {
    memory.use(chunks[static_cast<std::size_t>(k)]);
    const auto* bytes = static_cast<const unsigned char*>(chunks[static_cast<std::size_t>(k)]);
    EXPECT_EQ(bytes[0], k);
    EXPECT_EQ(bytes[kBytes / 2 + 1], k);
    EXPECT_EQ(bytes[kBytes - 1], k);
  }
  EXPECT_GT(memory.round(), round) << "a caller learns that chunks were unloaded";
  if (kIsMemoryOwn) {
    EXPECT_LT(own_kb() - before_kb, 70000) << "of 200 MB that were read";
  }
  memory.release(chunks[3]);
  EXPECT_EQ(memory.allocate(), chunks[3]) << "what was given back is used again";
}

TEST(FileChunkAllocator, WithoutAFileItIsTheHeap) {
  FileChunkAllocator memory("/proc/no/such/folder");
  void* chunk = memory.allocate();
  std::memset(chunk, 1, kBytes);
  EXPECT_EQ(memory.num_on_heap(), 1u);
  for (std::size_t k = 0; k <= 2 * FileChunkAllocator::kLoadedMax; ++k) memory.use(chunk);
  EXPECT_EQ(static_cast<const char*>(chunk)[kBytes / 2], 1) << "the heap is never unloaded";
  memory.release(chunk);
}

}  // namespace
}  // namespace orchard::io
