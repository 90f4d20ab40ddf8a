// SPDX-License-Identifier: BSD-3-Clause
#include "cli/paths.hpp"

#include <filesystem>

#include "io/folder.hpp"

namespace orchard::cli {

void make_parent_folder(const std::string& file_path) {
  const std::filesystem::path folder = std::filesystem::path(file_path).parent_path();
  if (!folder.empty()) io::make_folder(folder.string());
}

}  // namespace orchard::cli
