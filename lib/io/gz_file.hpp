// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace orchard::io {

/// Reads a file, plain or gzip-compressed, of which a recording or a table may be made.
class GzFile {
 public:
  /// `kind` names the file in messages, such as "CSV file". Throws FileError.
  GzFile(const std::string& path, const char* kind);
  ~GzFile();
  GzFile(const GzFile&) = delete;
  GzFile& operator=(const GzFile&) = delete;

  /// Appends some bytes; false at the end. Throws FileError for damage, which the checksum shows,
  /// and for a file that unpacks to more than any recording does.
  bool read(std::string& buffer);

  std::uint64_t num_read_bytes() const { return num_read_bytes_; }

 private:
  std::string path_;
  void* file_;
  std::uint64_t num_read_bytes_ = 0;
};

}  // namespace orchard::io
