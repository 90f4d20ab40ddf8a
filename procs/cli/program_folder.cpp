// SPDX-License-Identifier: BSD-3-Clause
#include "cli/program_folder.hpp"

#include <filesystem>
#include <system_error>

#include "io/file_error.hpp"

namespace orchard::cli {

std::string program_folder() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error)
    throw io::FileError(
        "the folder of orchard's programs cannot be determined: /proc/self/exe cannot be read");
  return self.parent_path().string();
}

}  // namespace orchard::cli
