// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace orchard::io {

/// The folder that a running mapper saves into: tried before anything is mapped, one process's
/// alone, and never with another map's files under the new ones.
class MapPlace {
 public:
  /// Makes the folder, locks it, tries to write there, and removes the temporaries that killed
  /// processes of ours left. Throws FileError when it cannot be written, or when another mapper
  /// saves there.
  explicit MapPlace(std::string folder);
  ~MapPlace();
  MapPlace(const MapPlace&) = delete;
  MapPlace& operator=(const MapPlace&) = delete;

  const std::string& folder() const { return folder_; }
  std::string file(const std::string& name) const;

  /// Whether a file of a map stands there.
  bool holds_map() const;

  /// Moves all files of a map, and those named in `more`, into a folder within this one, named
  /// after the time of the newest of them; its path, "" when there was none. Throws FileError.
  std::string set_aside(const std::vector<std::string>& more);

  /// What is left on its disk for who may write there; without end where that cannot be told.
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
