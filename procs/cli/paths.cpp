// SPDX-License-Identifier: BSD-3-Clause
#include "cli/paths.hpp"

#include <filesystem>

#include "io/file_error.hpp"
#include "io/folder.hpp"

namespace orchard::cli {

void make_parent_folder(const std::string& file_path) {
  const std::filesystem::path folder = std::filesystem::path(file_path).parent_path();
  if (!folder.empty()) io::make_folder(folder.string());
}

void require_free(const std::string& file_path, bool overwrite) {
  std::error_code error;
  if (overwrite || !std::filesystem::exists(file_path, error)) return;
  throw io::FileError(file_path +
                      " exists already; give another name, or --overwrite to replace it");
}

}  // namespace orchard::cli
