// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace orchard::io {

/// The folder into which a running mapper saves: checked before mapping starts, locked for one
/// process, and never with files of another map among the new ones.
class MapFolderLock {
 public:
  /// Creates and locks the folder, tests writing, and removes temporary files of killed mappers.
  /// Throws FileError when the folder is not writable or another mapper uses it.
  explicit MapFolderLock(std::string folder);
  ~MapFolderLock();
  MapFolderLock(const MapFolderLock&) = delete;
  MapFolderLock& operator=(const MapFolderLock&) = delete;

  const std::string& folder() const { return folder_; }
  std::string file(const std::string& name) const;

  /// Moves all files of a map, and those named in `more`, into a subfolder named after the time of
  /// the newest one. Returns its path, or "" if there were none. Throws FileError.
  std::string set_aside(const std::vector<std::string>& more);

  /// Free disk space for this user [bytes]; the maximum value if unknown.
  std::uint64_t free_bytes() const;

  int num_removed_temporaries() const { return num_removed_temporaries_; }

 private:
  void lock();
  void try_to_write() const;
  void remove_temporaries();

  std::string folder_;
  int fd_ = -1;
  int num_removed_temporaries_ = 0;
};

}  // namespace orchard::io
