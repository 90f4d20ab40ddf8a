// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/file_chunk_allocator.hpp"

namespace orchard::io {

/// State of a process at one moment, stored in one file. From it and the later records of a journal
/// the process resumes as if it had not ended.
struct Snapshot {
  std::uint64_t journal_number = 0;  ///< journal up to which the state is valid
  std::uint64_t journal_bytes = 0;
  std::vector<PersistentChunk>
      chunks;  ///< chunks of the FileChunkAllocator beside it, in order of number
  std::string state;
};

/// Result of reading a snapshot.
struct SnapshotReading {
  enum class State { kAbsent, kWhole, kOtherMaker, kDamaged };
  State state = State::kAbsent;
  Snapshot snapshot;  ///< for kWhole
};

/// Replaces the file at `path`. Throws FileError and then leaves the earlier file.
///
/// Layout, little-endian: "ORCHSNAP", version u32, identity i64, journal number u64, journal bytes
/// u64, number of chunks u32, then number u32 and CRC-32 u32 of each chunk, size of the state u64,
/// the state, CRC-32 of everything before u32.
void write_snapshot(const std::string& path, std::int64_t identity, const Snapshot& snapshot);

/// Reads a snapshot with that identity. Throws FileError when the file exists but cannot be read.
SnapshotReading read_snapshot(const std::string& path, std::int64_t identity);

}  // namespace orchard::io
