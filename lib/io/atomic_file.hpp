// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// Reads a whole file of at most `bytes_max`. Throws FileError with `advice` as the remedy when it
/// cannot be read or is larger, as one that never ends is.
std::string read_file(const std::string& path, std::size_t bytes_max, const std::string& advice);

/// Replaces the content of `path` atomically: a reader sees either the old or the new file. Writes
/// a temporary file beside it, syncs and renames it. Throws FileError (full disk, no permission)
/// and then leaves the old file unchanged.
void write_file_atomically(const std::string& path, std::string_view content);

/// The same for libraries that write to a file name: `write` fills the temporary path it is given
/// (same extension as `path`). If it throws, the old file remains unchanged.
void replace_file_atomically(const std::string& path,
                             const std::function<void(const std::string& temporary)>& write);

/// Produces a text in pieces: fills `piece` and returns true, or returns false after the last one.
using TextPieces = std::function<bool(std::string& piece)>;

/// Replaces several files together: all are written and synced under temporary names before the
/// first is renamed, so a full disk leaves every old file unchanged.
class FileReplacement {
 public:
  FileReplacement() = default;
  ~FileReplacement();  ///< without commit(): removes the temporary files
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  /// Prepares new content for `path`. Throws FileError.
  void write(const std::string& path, std::string_view content);
  /// The same for a text that would be large as a whole.
  void write(const std::string& path, const TextPieces& next);

  /// Returns a temporary path beside `path` with the same extension, for a library that writes to a
  /// file name.
  std::string temporary_for(const std::string& path);

  /// Syncs and renames all files. Throws FileError.
  void commit();

 private:
  struct Entry {
    std::string path;
    std::string temporary;
  };
  std::vector<Entry> entries_;
};

/// Writes all bytes to an open file. Throws FileError naming `path` (full disk).
void write_fully(int fd, const std::string& path, const void* bytes, std::size_t size);

/// Syncs a file to the disk. Throws FileError naming `path` on failure.
void sync_file(int fd, const std::string& path);

/// Renames a file and syncs its folder, so that the renaming survives a power cut. Throws
/// FileError.
void rename_durably(const std::string& from, const std::string& to);

/// Resolves a symbolic link at `path` to the file to be replaced. Throws FileError when something
/// other than a regular file is there.
std::string replaceable_path(const std::string& path);

}  // namespace orchard::io
