// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mapping/store/chunk_memory.hpp"

namespace orchard::io {

/// A chunk that a file keeps: its number, and the CRC-32 of its bytes.
struct KeptChunk {
  std::uint32_t number = 0;
  std::uint32_t crc = 0;
};

/// Chunks in a file: only those given last stand in memory, the others come when they are asked
/// for. Where the disk has little room, a chunk is the heap's.
///
/// A file without a name goes away with the process. One with a name can be gone on with: what
/// keep() was asked for stays as it is in the file until release_others() after the next time.
class FileMemory : public mapping::ChunkMemory {
 public:
  /// The file is made in `folder`, which must be there, at the first chunk. With a `name` it
  /// replaces the one of that name.
  explicit FileMemory(std::string folder, std::string name = {})
      : folder_(std::move(folder)), name_(std::move(name)) {}
  ~FileMemory() override;
  FileMemory(const FileMemory&) = delete;
  FileMemory& operator=(const FileMemory&) = delete;

  void* take() override;
  void give_back(void* chunk) noexcept override;
  void rest() noexcept override;
  std::int64_t keep(void* chunk) override;
  void* find(std::int64_t number) override;

  /// What keep() was asked for so far is not meant.
  void begin_keeping() { to_keep_.clear(); }

  /// Writes what keep() was asked for since then to the disk; all of it, in order of number. Throws
  /// FileError.
  std::vector<KeptChunk> write_kept();

  /// Only what write_kept() gave last needs to be kept any longer.
  void release_others();

  /// Goes on with the named file of an earlier process, before anything else. Whether all of these
  /// chunks are in it as they were.
  bool restore(const std::vector<KeptChunk>& chunks);

  std::size_t num_on_heap() const { return num_on_heap_; }

 private:
  using Mapped = std::pair<void*, std::uint32_t>;  ///< where, and its number
  bool open_file(bool anew) noexcept;
  void* map_next() noexcept;
  void* map(std::uint32_t number) noexcept;
  const Mapped* mapped(const void* chunk) const;
  void cool_down(void* chunk);

  std::string folder_;
  std::string name_;
  int fd_ = -1;
  bool is_refused_ = false;          ///< no such file can be made there
  std::uint32_t num_in_file_ = 0;    ///< chunks, given out and given back
  std::vector<Mapped> mapped_;       ///< in order of address
  std::vector<void*> unused_;        ///< of those: given back
  std::deque<void*> warm_;           ///< given last
  std::vector<KeptChunk> kept_;      ///< in order of number
  std::vector<KeptChunk> written_;   ///< by write_kept() last
  std::set<std::uint32_t> to_keep_;  ///< asked for since
  std::vector<void*> released_;      ///< given back, but still kept
  std::size_t num_on_heap_ = 0;
};

}  // namespace orchard::io
