// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/farm/farm_folder.hpp"

namespace orchard::cli {

/// Options of `orchard farm status DIR`.
struct FarmStatusOptions {
  std::string folder;
  bool json = false;
};

/// Prints finished results, results set aside with reasons, and open steps with their expected
/// cost. Throws io::FileError.
int run_farm_status(const FarmStatusOptions& options);

/// Returns the same status of a farm that has been read, as plain text or JSON.
std::string status_text(const FarmFolder& farm, const FarmContent& content,
                        const std::vector<farm::FarmTask>& tasks, bool json);

}  // namespace orchard::cli
