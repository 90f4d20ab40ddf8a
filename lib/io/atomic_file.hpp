// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// Replaces `path` by `content` so that a reader sees the old file or the new one, never a half:
/// writes a temporary beside it, syncs, renames. Throws FileError (full disk, no permission) and
/// then leaves the old file as it was.
void write_file_atomically(const std::string& path, std::string_view content);

/// The same for libraries that write by name: `write` fills the temporary path it is given (same
/// extension as `path`); throwing from it leaves the old file as it was.
void replace_file_atomically(const std::string& path,
                             const std::function<void(const std::string& temporary)>& write);

/// Several files replaced together: all are written and synced under temporary names before the
/// first is renamed, so a full disk leaves every old file as it was.
class FileReplacement {
 public:
  FileReplacement() = default;
  ~FileReplacement();  ///< without commit(): removes the temporaries
  FileReplacement(const FileReplacement&) = delete;
  FileReplacement& operator=(const FileReplacement&) = delete;

  /// Prepares a new content of `path`. Throws FileError.
  void write(const std::string& path, std::string_view content);

  /// A new name beside `path`, same extension, for a library that writes by name.
  std::string temporary_for(const std::string& path);

  /// Syncs and renames all. Throws FileError.
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

/// Throws FileError naming `path` when the file's bytes do not reach the disk.
void sync_file(int fd, const std::string& path);

/// Renames and makes the renaming last (syncs the folder). Throws FileError.
void rename_durably(const std::string& from, const std::string& to);

/// The file that `path` stands for when it is a symbolic link. Throws FileError when something
/// is there that is no regular file and so must not be replaced by one.
std::string replaceable_path(const std::string& path);

}  // namespace orchard::io
