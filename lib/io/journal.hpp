// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// Result of reading a journal.
struct JournalReading {
  enum class State {
    kAbsent,      ///< no file, or one without a commit
    kWhole,       ///< at most the last block is incomplete (the process was killed)
    kOtherMaker,  ///< written with another identity
    kDamaged,     ///< damaged before its end, or not a journal
  };
  State state = State::kAbsent;
  std::int64_t num_records = 0;
  std::uint64_t num_good_bytes = 0;  ///< up to the end of the last whole block
  std::uint64_t num_torn_bytes = 0;  ///< bytes after that
  std::int64_t num_missing = 0;      ///< records that a full disk kept from being written
  std::string reason;                ///< for kDamaged: one clause for the user
};

/// Receives one record of a journal: its kind and its bytes, which are valid only during the call.
using JournalRecordHook = std::function<void(std::uint8_t kind, std::string_view bytes)>;

/// Reads a journal with the given identity. Holds at most one block in memory. Records are passed
/// on before a later block turns out to be damaged. Throws FileError when the file exists but
/// cannot be read.
JournalReading read_journal(const std::string& path, std::int64_t identity,
                            const JournalRecordHook& on_record = {});

/// An append-only file of records, written in compressed blocks with a checksum each. Committed
/// records survive the process; an incomplete block is ignored when reading.
///
/// Layout, little-endian. Header: "ORCHJRNL", version u32, identity i64, CRC-32 of these. Block:
/// mark u32, inflated size u32, stored size u32, CRC-32 of the stored bytes u32, a Zstandard
/// frame of records. Record: kind u8, size u32, bytes. Records of kind kGapKind are the journal's
/// own: the number u32 of records dropped in their place.
class Journal {
 public:
  /// Continues after the first `num_good_bytes` of the file at `path`, as given by read_journal();
  /// 0 starts a new journal. Throws FileError.
  Journal(std::string path, std::int64_t identity, std::uint64_t num_good_bytes);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  static constexpr std::uint8_t kGapKind = 254;

  /// Adds a record to the next commit(); also while one runs in another thread. If the file cannot
  /// be written for long, the oldest waiting records are dropped, which the file then says.
  void add(std::uint8_t kind, const void* bytes, std::size_t size);

  /// Writes and syncs the waiting records. Throws FileError (full disk); then they still wait, and
  /// the file ends with its last complete block.
  void commit();

 private:
  void write_header();
  void write_block(const std::string& records);

  struct Waiting {
    std::string records;
    std::uint32_t count = 0;
  };
  std::string path_;
  std::int64_t identity_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
  std::mutex committing_;          ///< one commit() at a time
  std::mutex adding_;              ///< of what follows
  std::vector<Waiting> waiting_;   ///< oldest first; records are added to the last one
  std::uint32_t num_dropped_ = 0;  ///< since the last block was written
};

}  // namespace orchard::io
