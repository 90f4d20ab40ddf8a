// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/camera_import.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

#include "io/file_error.hpp"

namespace orchard::io {

ImportedCamera read_camera_file(const std::string& path) {
  constexpr std::uintmax_t kMaxBytes = std::uintmax_t{1} << 20;
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw FileError(path + ": cannot be read (" + error.message() + ")");
  if (size == 0 || size > kMaxBytes) {
    throw FileError(path + ": " + std::to_string(size) +
                    " bytes; a camera description has 1 byte to 1 MB");
  }
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file || text.size() != size) throw FileError(path + ": could not be read completely");
  if (std::filesystem::path(path).extension() == ".m") return parse_camera_matlab(text, path);
  return parse_camera_yaml(text, path);
}

}  // namespace orchard::io
