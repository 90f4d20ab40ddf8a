// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "mapping/store/chunk_memory.hpp"

namespace orchard::io {

/// Chunks in a file without a name, which goes away with the process: only those given last stand
/// in memory, the others come when they are asked for. Where the disk has little room, a chunk
/// is the heap's.
class FileMemory : public mapping::ChunkMemory {
 public:
  /// The file is made in `folder`, which must be there, at the first chunk.
  explicit FileMemory(std::string folder) : folder_(std::move(folder)) {}
  ~FileMemory() override;
  FileMemory(const FileMemory&) = delete;
  FileMemory& operator=(const FileMemory&) = delete;

  void* take() override;
  void give_back(void* chunk) noexcept override;

  std::size_t num_on_heap() const { return num_on_heap_; }

 private:
  void* map_next() noexcept;
  bool is_of_file(void* chunk) const;

  std::string folder_;
  int fd_ = -1;
  bool is_refused_ = false;       ///< no such file can be made there
  std::uint64_t file_bytes_ = 0;  ///< given out, and those given back
  std::vector<void*> mapped_;     ///< in order of address
  std::vector<void*> unused_;     ///< of those: given back
  std::deque<void*> warm_;        ///< given last
  std::size_t num_on_heap_ = 0;
};

}  // namespace orchard::io
