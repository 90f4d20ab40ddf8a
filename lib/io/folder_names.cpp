// SPDX-License-Identifier: BSD-3-Clause
#include "io/folder_names.hpp"

#include <algorithm>
#include <filesystem>

namespace orchard::io {

std::vector<std::string> folder_names(const std::string& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace orchard::io
