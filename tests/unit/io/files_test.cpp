// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "io/file_chunk_allocator.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/journal.hpp"
#include "io/progress_bar.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

using State = JournalReading::State;
using Records = std::vector<std::pair<int, std::string>>;

TEST(MakeFolder, MakesThoseAboveItAndLeavesOneThatIsThere) {
  const TestFolder folder;
  make_folder(folder / "a/b/c");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b/c"));
  make_folder(folder / "a/b");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b/c"));
}

TEST(MakeFolder, SaysWhichFolderWhyAndWhatToDoInstead) {
  const TestFolder folder;
  std::ofstream(folder / "file") << "not a folder";
  EXPECT_EQ(refusal_of([&] { make_folder(folder / "file/below", "give another one with --out"); }),
            folder /
                "file/below: cannot be created as a folder (Not a directory); give another one "
                "with --out");
  EXPECT_THROW(make_folder(folder / "file"), FileError);  // a file of that name is there
}

std::string text_of(int k) { return "record " + std::to_string(k * k) + std::string(k % 7, '!'); }

class JournalTest : public ::testing::Test {
 protected:
  /// Ten blocks of four records.
  JournalTest() {
    Journal journal(path, 77, 0);
    for (int k = 0; k < 40; ++k) {
      const std::string text = text_of(k);
      journal.add(static_cast<std::uint8_t>(k % 5), text.data(), text.size());
      written.emplace_back(k % 5, text);
      if (k % 4 == 3) journal.commit();
    }
  }
  JournalReading read(Records* records = nullptr, std::int64_t identity = 77) const {
    return read_journal(path, identity, [records](std::uint8_t kind, std::string_view bytes) {
      if (records != nullptr) records->emplace_back(kind, bytes);
    });
  }
  bool begins_as_written(const Records& records) const {
    return records.size() <= written.size() &&
           std::equal(records.begin(), records.end(), written.begin());
  }

  TestFolder folder;
  const std::string path = folder / "a.journal";
  Records written;
};

TEST_F(JournalTest, GivesBackWhatWasCommitted) {
  Records records;
  const JournalReading reading = read(&records);
  EXPECT_EQ(reading.state, State::kWhole);
  EXPECT_EQ(reading.num_records, 40);
  EXPECT_EQ(reading.num_torn_bytes, 0u);
  EXPECT_EQ(reading.num_missing, 0);
  EXPECT_EQ(reading.num_good_bytes, std::filesystem::file_size(path));
  EXPECT_EQ(records, written);
}

TEST_F(JournalTest, WhatWasNotCommittedIsNotThere) {
  Journal journal(path, 77, read().num_good_bytes);
  journal.add(1, "x", 1);
  EXPECT_EQ(read().num_records, 40);
  journal.commit();
  EXPECT_EQ(read().num_records, 41);
}

TEST_F(JournalTest, CutAnywhereItHoldsEveryWholeBlockAndGoesOn) {
  const std::string bytes = read_bytes(path);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    write_bytes(path, bytes.substr(0, size));
    Records records;
    const JournalReading reading = read(&records);
    ASSERT_TRUE(reading.state == State::kWhole || (size < 24 && reading.state == State::kAbsent))
        << size;
    ASSERT_TRUE(begins_as_written(records)) << size;
    ASSERT_EQ(records.size() % 4, 0u);
    ASSERT_EQ(reading.num_good_bytes + reading.num_torn_bytes,
              reading.state == State::kWhole ? size : 0u);
    Journal journal(path, 77, reading.num_good_bytes);
    journal.add(9, "more", 4);
    journal.commit();
    Records after;
    ASSERT_EQ(read(&after).state, State::kWhole) << size;
    ASSERT_EQ(after.size(), records.size() + 1);
    ASSERT_EQ(after.back(), (std::pair<int, std::string>{9, "more"}));
  }
}

TEST_F(JournalTest, AFlippedByteNeverGivesAWrongRecord) {
  const std::string bytes = read_bytes(path);
  int num_damaged = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(~flipped[at]);
    write_bytes(path, flipped);
    Records records;
    const JournalReading reading = read(&records);
    ASSERT_TRUE(begins_as_written(records)) << at;
    ASSERT_LT(records.size(), written.size()) << at;
    if (reading.state == State::kDamaged) {
      ++num_damaged;
      EXPECT_FALSE(reading.reason.empty());
    } else {  // only where the damage reaches the end can it be the torn end of a write
      ASSERT_EQ(reading.state, State::kWhole) << at;
      ASSERT_GT(reading.num_torn_bytes, 0u) << at;
    }
  }
  EXPECT_GT(num_damaged, static_cast<int>(bytes.size()) / 2);
}

TEST_F(JournalTest, ZerosAfterAPowerCutAreATornEnd) {
  write_bytes(path, read_bytes(path) + std::string(5000, '\0'));
  EXPECT_EQ(read().state, State::kWhole);
  EXPECT_EQ(read().num_records, 40);
  EXPECT_EQ(read().num_torn_bytes, 5000u);
}

TEST_F(JournalTest, OfAnotherMakerOrNoJournalIsSaid) {
  EXPECT_EQ(read(nullptr, 78).state, State::kOtherMaker);
  write_bytes(path, "id,class,x_m,y_m,n,roc_mean,probability\n");
  EXPECT_EQ(read().state, State::kDamaged);
  EXPECT_EQ(read_journal(folder / "none", 1).state, State::kAbsent);
}

TEST_F(JournalTest, AHugeClaimedSizeAllocatesNothing) {
  std::string bytes = read_bytes(path);
  bytes.replace(24 + 4, 4, "\xff\xff\xff\x7f");  // of the first block, inflated
  write_bytes(path, bytes);
  EXPECT_EQ(read().state, State::kDamaged);
  EXPECT_EQ(read().num_records, 0);
}

TEST(Journal, WhatAFullDiskMadeItDropIsSaidByTheFile) {
  const TestFolder folder;
  const std::string path = folder / "a.journal";
  const std::string large(1 << 20, 'x');
  {
    Journal journal(path, 1, 0);
    for (int k = 0; k < 100; ++k) journal.add(3, large.data(), large.size());  // no commit: full
    journal.commit();
    journal.add(3, "y", 1);
    journal.commit();
  }
  const JournalReading reading = read_journal(path, 1);
  EXPECT_EQ(reading.state, State::kWhole);
  EXPECT_GT(reading.num_missing, 10);
  EXPECT_EQ(reading.num_records + reading.num_missing, 101);
}

TEST(Journal, AFullDiskKeepsWhatWaitsAndTheFileWhole) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TestFolder folder;
  std::filesystem::create_symlink("/dev/full", folder / "full");
  EXPECT_THROW(Journal(folder / "full", 1, 0), FileError);
  EXPECT_THROW(Journal(folder / "none/a.journal", 1, 0), FileError);
}

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

TEST(ProgressBar, TimesToWaitAreRoundedUp) {
  EXPECT_EQ(waiting_text(-1.0), "0 s");
  EXPECT_EQ(waiting_text(0.2), "1 s");
  EXPECT_EQ(waiting_text(59.0), "59 s");
  EXPECT_EQ(waiting_text(59.1), "1 min");
  EXPECT_EQ(waiting_text(116.0), "2 min");
  EXPECT_EQ(waiting_text(3600.0), "1 h 0 min");
  EXPECT_EQ(waiting_text(7501.0), "2 h 6 min");
}

}  // namespace
}  // namespace orchard::io
