// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
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
  std::string reason;                ///< for kDamaged: one clause for the user
};

/// Receives one record of a journal: its kind and its bytes, which are valid only during the call.
using JournalRecordHook = std::function<void(std::uint8_t kind, std::string_view bytes)>;

/// Reads a journal with the given identity from its start, or from `from_bytes` on (a value of
/// Journal::num_bytes()). Holds at most one block in memory. Records are passed on before a later
/// block turns out to be damaged: for all or nothing, first read once without a hook. Throws
/// FileError when the file exists but cannot be read.
JournalReading read_journal(const std::string& path, std::int64_t identity,
                            const JournalRecordHook& on_record = {}, std::uint64_t from_bytes = 0);

/// An append-only file of records, written in compressed blocks with a checksum each. Committed
/// records survive the process; an incomplete block is ignored when reading.
///
/// Layout, little-endian. Header: "ORCHJRNL", version u32, identity i64, CRC-32 of these. Block:
/// mark u32, inflated size u32, stored size u32, CRC-32 of the stored bytes u32, zlib deflate
/// stream of records. Record: kind u8, size u32, bytes.
class Journal {
 public:
  /// Continues after the first `num_good_bytes` of the file at `path`, as given by read_journal();
  /// 0 starts a new journal. Throws FileError.
  Journal(std::string path, std::int64_t identity, std::uint64_t num_good_bytes);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Adds a record to the next commit(). If the file cannot be written for long, the oldest waiting
  /// records are dropped.
  void add(std::uint8_t kind, const void* bytes, std::size_t size);

  /// Writes and syncs the waiting records. Throws FileError (full disk); then they still wait, and
  /// the file ends with its last complete block.
  void commit();

  /// Drops all records, including the waiting ones, and starts a new journal with that identity.
  void begin_anew(std::int64_t identity);

  /// Size of the file.
  std::uint64_t num_bytes() const { return size_; }

  std::int64_t num_dropped() const { return num_dropped_; }

 private:
  void write_header();
  void write_block(const std::string& records);

  struct Waiting {
    std::string records;
    std::int64_t count = 0;
  };
  std::string path_;
  std::int64_t identity_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
  std::vector<Waiting> waiting_;  ///< oldest first; records are added to the last one
  std::int64_t num_dropped_ = 0;
};

}  // namespace orchard::io
