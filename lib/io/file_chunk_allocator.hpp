// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "mapping/store/chunk_allocator.hpp"

namespace orchard::io {

/// A chunk that must remain unchanged in the file: its index in the file and the CRC-32 of its
/// bytes.
struct PersistentChunk {
  std::uint32_t number = 0;
  std::uint32_t crc = 0;
};

/// Allocates chunks in a memory-mapped file, of which at most `loaded_max` occupy memory. When the
/// disk is nearly full, chunks are allocated on the heap.
///
/// A file without a name is deleted with the process. A named one can be used again by the next
/// process: chunks passed to keep() remain unchanged in the file until release_others() after the
/// next sync_persistent().
class FileChunkAllocator : public mapping::ChunkAllocator {
 public:
  /// The file is created in the existing folder `folder` with the first chunk. With a `name` it
  /// replaces the file of that name.
  explicit FileChunkAllocator(std::string folder, std::string name = {},
                              std::size_t loaded_max = kLoadedMax)
      : folder_(std::move(folder)), name_(std::move(name)), loaded_max_(loaded_max) {}
  ~FileChunkAllocator() override;
  FileChunkAllocator(const FileChunkAllocator&) = delete;
  FileChunkAllocator& operator=(const FileChunkAllocator&) = delete;

  void* allocate() override;
  void release(void* chunk) noexcept override;
  void use(void* chunk) override;
  std::int64_t keep(void* chunk) override;
  void* find(std::int64_t number) override;

  /// Forgets all calls of keep() so far.
  void begin_persisting() { to_keep_.clear(); }

  /// Syncs the chunks passed to keep() since begin_persisting() to the disk and returns them in
  /// order of number. Throws FileError.
  std::vector<PersistentChunk> sync_persistent();

  /// Allows the reuse of all chunks except those returned by the last sync_persistent().
  void release_others();

  /// Opens the named file of an earlier process; call it before any other function. Returns whether
  /// all of these chunks are in it unchanged.
  bool restore(const std::vector<PersistentChunk>& chunks);

  /// A scan of the mapper reads what was observed of the rows around: some 2 km of path, about 35
  /// chunks. With fewer loaded than that, each scan would load them again.
  static constexpr std::size_t kLoadedMax = 64;
  /// The same 2 km take 9 chunks of the pose's observations.
  static constexpr std::size_t kPoseLoadedMax = 16;

  std::size_t num_on_heap() const { return num_on_heap_; }

 private:
  using Mapped = std::pair<void*, std::uint32_t>;  ///< address and number
  bool open_file(bool anew) noexcept;
  void* map_next() noexcept;
  void* map(std::uint32_t number) noexcept;
  const Mapped* mapped(const void* chunk) const;
  void unload() noexcept;

  std::string folder_;
  std::string name_;
  std::size_t loaded_max_;
  int fd_ = -1;
  bool is_refused_ = false;               ///< the file cannot be created in this folder
  std::uint32_t num_in_file_ = 0;         ///< chunks in the file, in use or not
  std::vector<Mapped> mapped_;            ///< in order of address
  std::vector<void*> unused_;             ///< mapped but given back
  std::vector<void*> loaded_;             ///< used in this round
  std::vector<PersistentChunk> kept_;     ///< in order of number
  std::vector<PersistentChunk> written_;  ///< result of the last sync_persistent()
  std::set<std::uint32_t> to_keep_;       ///< passed to keep() since then
  std::vector<void*> released_;           ///< given back, but still to be kept
  std::size_t num_on_heap_ = 0;
};

}  // namespace orchard::io
