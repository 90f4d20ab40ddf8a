// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/file_memory.hpp"

namespace orchard::io {

/// The state of a process at one moment, in one file: from it and the records of a journal that
/// came later the process goes on as if it had never ended.
struct Snapshot {
  std::uint64_t journal_number = 0;  ///< of the journal that it covers up to:
  std::uint64_t journal_bytes = 0;
  std::vector<KeptChunk> chunks;  ///< of the FileMemory beside it, in order of number
  std::string state;
};

/// What a snapshot's file held.
struct SnapshotReading {
  enum class State { kAbsent, kWhole, kOtherMaker, kDamaged };
  State state = State::kAbsent;
  Snapshot snapshot;  ///< of kWhole
};

/// Replaces the file at `path`. Throws FileError and then leaves the earlier one.
///
/// Layout, little-endian: "ORCHSNAP", version u32, identity i64, journal number u64, bytes u64,
/// number of chunks u32, of each its number u32 and CRC-32 u32, size of the state u64, the state,
/// CRC-32 of all that u32.
void write_snapshot(const std::string& path, std::int64_t identity, const Snapshot& snapshot);

/// Reads one of that identity. Throws FileError when it is there and cannot be read.
SnapshotReading read_snapshot(const std::string& path, std::int64_t identity);

}  // namespace orchard::io
