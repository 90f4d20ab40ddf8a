// SPDX-License-Identifier: BSD-3-Clause
#include "io/folder.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include "io/file_error.hpp"

namespace orchard::io {

void make_folder(const std::string& folder, const std::string& advice) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::error_code unreadable;
  if (std::filesystem::is_directory(folder, unreadable)) return;
  throw SystemError(folder + ": cannot be created as a folder" +
                    (error ? " (" + error.message() + ")" : std::string()) +
                    (advice.empty() ? std::string() : "; " + advice));
}

void remove_other_files(const std::string& folder, const std::set<std::string>& names,
                        const std::function<bool(const std::string& name)>& is_ours) {
  std::error_code error;
  std::vector<std::filesystem::path> others;
  for (const auto& file : std::filesystem::directory_iterator(folder, error)) {
    const std::string name = file.path().filename().string();
    if (is_ours(name) && names.count(name) == 0) others.push_back(file.path());
  }
  for (const std::filesystem::path& other : others) std::filesystem::remove(other, error);
  if (names.empty()) std::filesystem::remove(folder, error);  // fails if anything else is in it
}

std::string file_in(const std::string& folder_or_file, const char* name) {
  std::error_code error;
  const std::filesystem::path path(folder_or_file);
  return std::filesystem::is_directory(path, error) ? (path / name).string() : folder_or_file;
}

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
