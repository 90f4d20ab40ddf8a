// SPDX-License-Identifier: BSD-3-Clause
#include "io/folder.hpp"

#include <filesystem>

#include "io/file_error.hpp"

namespace orchard::io {

void make_folder(const std::string& folder, const std::string& advice) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::error_code unreadable;
  if (std::filesystem::is_directory(folder, unreadable)) return;
  throw FileError(folder + ": cannot be created as a folder" +
                  (error ? " (" + error.message() + ")" : std::string()) +
                  (advice.empty() ? std::string() : "; " + advice));
}

}  // namespace orchard::io
