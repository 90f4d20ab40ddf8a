// SPDX-License-Identifier: BSD-3-Clause
#include "io/gz_file.hpp"

#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "io/file_error.hpp"
#include "io/unpacking_budget.hpp"

namespace orchard::io {
namespace {

constexpr std::size_t kReadBytes = std::size_t{1} << 16;

gzFile open(const std::string& path, const char* kind) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw FileError(path + " is a folder, not a " + kind);
  }
  errno = 0;
  const gzFile file = ::gzopen(path.c_str(), "rb");  // reads uncompressed files unchanged
  if (file == nullptr) {
    throw FileError(path + ": cannot be opened (" +
                    (errno != 0 ? std::strerror(errno) : "out of memory") + "); give an existing " +
                    kind);
  }
  ::gzbuffer(file, kReadBytes);
  return file;
}

}  // namespace

GzFile::GzFile(const std::string& path, const char* kind) : path_(path), file_(open(path, kind)) {}

GzFile::~GzFile() { ::gzclose(static_cast<gzFile>(file_)); }

bool GzFile::read(std::string& buffer) {
  const auto file = static_cast<gzFile>(file_);
  const std::size_t size = buffer.size();
  buffer.resize(size + kReadBytes);
  const int count = ::gzread(file, buffer.data() + size, kReadBytes);
  int code = Z_OK;
  const char* message = ::gzerror(file, &code);
  if (count < 0 || code == Z_BUF_ERROR) {  // Z_BUF_ERROR: the compressed data are truncated
    throw FileError(path_ + ": damaged or truncated (" + message + "); copy or record it again");
  }
  buffer.resize(size + static_cast<std::size_t>(count));
  num_read_bytes_ += static_cast<std::uint64_t>(count);
  if (!is_plausibly_packed(static_cast<std::uint64_t>(::gzoffset(file)), num_read_bytes_)) {
    throw FileError(path_ + ": unpacks to over " + std::to_string(num_read_bytes_ >> 20) +
                    " MB: no recording packs so well; it is made to exhaust who reads it");
  }
  return count > 0;
}

}  // namespace orchard::io
