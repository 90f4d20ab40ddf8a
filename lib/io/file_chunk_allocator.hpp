// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "mapping/store/chunked_array.hpp"

namespace orchard::io {

/// Allocates chunks in a memory-mapped file, of which at most `loaded_max` occupy memory. The file
/// has no name, so it is deleted with the process. When the disk is nearly full, chunks are
/// allocated on the heap.
class FileChunkAllocator : public mapping::ChunkAllocator {
 public:
  /// The file is created in the existing folder `folder` with the first chunk.
  explicit FileChunkAllocator(std::string folder, std::size_t loaded_max = kLoadedMax)
      : folder_(std::move(folder)), loaded_max_(loaded_max) {}
  ~FileChunkAllocator() override;
  FileChunkAllocator(const FileChunkAllocator&) = delete;
  FileChunkAllocator& operator=(const FileChunkAllocator&) = delete;

  void* allocate() override;
  void release(void* chunk) noexcept override;
  void use(void* chunk) override;

  /// A scan of the mapper reads what was observed of the rows around: some 2 km of path, about 35
  /// chunks. With fewer loaded than that, each scan would load them again.
  static constexpr std::size_t kLoadedMax = 64;
  /// The same 2 km take 9 chunks of the pose's observations.
  static constexpr std::size_t kPoseLoadedMax = 16;

  std::size_t num_on_heap() const { return num_on_heap_; }

 private:
  bool open_file() noexcept;
  void* map_next() noexcept;
  bool is_mapped(const void* chunk) const;
  void unload() noexcept;

  std::string folder_;
  std::size_t loaded_max_;
  int fd_ = -1;
  bool is_refused_ = false;    ///< the file cannot be created in this folder
  std::vector<void*> mapped_;  ///< in order of address
  std::vector<void*> unused_;  ///< mapped but given back
  std::vector<void*> loaded_;  ///< used in this round
  std::size_t num_on_heap_ = 0;
};

}  // namespace orchard::io
