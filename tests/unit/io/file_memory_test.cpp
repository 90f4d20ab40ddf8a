// SPDX-License-Identifier: BSD-3-Clause
#include "io/file_memory.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

constexpr std::size_t kBytes = FileMemory::kChunkBytes;

long own_kb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) return std::stol(line.substr(6));
  }
  return -1;
}

TEST(FileMemory, KeepsWhatIsWrittenAndLittleInMemory) {
  const TestFolder folder;
  FileMemory memory(folder.path());
  std::vector<void*> chunks;
  const long before_kb = own_kb();
  for (int k = 0; k < 100; ++k) {
    chunks.push_back(memory.take());
    std::memset(chunks.back(), k, kBytes);
  }
  if (memory.num_on_heap() > 0) GTEST_SKIP() << "no file without a name can be made here";
  EXPECT_LT(own_kb() - before_kb, 20000) << "of 100 MB";
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "the file has no name";
  for (int k = 0; k < 100; ++k) {
    const auto* bytes = static_cast<const unsigned char*>(chunks[static_cast<std::size_t>(k)]);
    EXPECT_EQ(bytes[0], k);
    EXPECT_EQ(bytes[kBytes / 2 + 1], k);
    EXPECT_EQ(bytes[kBytes - 1], k);
  }
  memory.give_back(chunks[3]);
  EXPECT_EQ(memory.take(), chunks[3]) << "what was given back is used again";
}

TEST(FileMemory, WithoutAFileItIsTheHeap) {
  FileMemory memory("/proc/no/such/folder");
  void* chunk = memory.take();
  std::memset(chunk, 1, kBytes);
  EXPECT_EQ(memory.num_on_heap(), 1u);
  memory.give_back(chunk);
}

}  // namespace
}  // namespace orchard::io
