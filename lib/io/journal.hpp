// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// What a journal held when it was read.
struct JournalReading {
  enum class State {
    kAbsent,      ///< no file, or one that was never committed to
    kWhole,       ///< at most its last block is torn: a killed process's
    kOtherMaker,  ///< made with another identity
    kDamaged,     ///< something before its end does not hold together, or it is no journal
  };
  State state = State::kAbsent;
  std::int64_t num_records = 0;
  std::uint64_t num_good_bytes = 0;  ///< up to the end of the last whole block
  std::uint64_t num_torn_bytes = 0;  ///< after it
  std::string reason;                ///< of kDamaged: one clause for a person
};

/// Takes one record of a journal: its kind, and its bytes, which are gone after the call.
using JournalRecordHook = std::function<void(std::uint8_t kind, std::string_view bytes)>;

/// Reads a journal of that identity from its start, or from `from_bytes` on, which an earlier
/// Journal::num_bytes() told; never more than one block in memory. Records of
/// a journal that turns out kDamaged later have been handed over: whoever needs all or nothing
/// reads twice, without a hook first. Throws FileError when it is there and cannot be read.
JournalReading read_journal(const std::string& path, std::int64_t identity,
                            const JournalRecordHook& on_record = {}, std::uint64_t from_bytes = 0);

/// A file that records are appended to, in compressed blocks with a checksum each: what was
/// committed outlives the process, and a block that was torn is left out.
///
/// Layout, little-endian: "ORCHJRNL", version u32, identity i64, CRC-32 of these; then blocks: mark
/// u32, bytes when inflated u32, bytes in the file u32, CRC-32 of those u32, zlib's deflate stream
/// of records; a record: kind u8, size u32, bytes.
class Journal {
 public:
  /// Goes on after `num_good_bytes` of the file at `path`, as read_journal() told; 0 begins anew.
  /// Throws FileError.
  Journal(std::string path, std::int64_t identity, std::uint64_t num_good_bytes);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Keeps a record for the next commit(). When the file takes nothing for long, the oldest that
  /// wait are dropped.
  void add(std::uint8_t kind, const void* bytes, std::size_t size);

  /// Writes and syncs what waits. Throws FileError (full disk); then it still waits, and the file
  /// ends with its last whole block.
  void commit();

  /// Drops all records, those that wait, too: the file goes on as a new one of that identity.
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
  std::vector<Waiting> waiting_;  ///< the oldest first; the last one grows
  std::int64_t num_dropped_ = 0;
};

}  // namespace orchard::io
