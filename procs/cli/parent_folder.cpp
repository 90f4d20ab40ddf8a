// SPDX-License-Identifier: BSD-3-Clause
#include "cli/parent_folder.hpp"

#include <filesystem>

#include "io/file_error.hpp"

namespace orchard::cli {

void make_parent_folder(const std::string& file_path) {
  const std::filesystem::path folder = std::filesystem::path(file_path).parent_path();
  if (folder.empty()) return;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw io::FileError(file_path + " cannot be written: its folder cannot be made (" +
                        error.message() + ")");
  }
}

}  // namespace orchard::cli
