// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/farm/farm_folder.hpp"

namespace orchard::cli {

/// `orchard farm status DIR`.
struct FarmStatusOptions {
  std::string folder;
  bool json = false;
};

/// Says what is made, what was set aside and why, what is left to make and what it will cost.
/// Throws io::FileError.
int run_farm_status(const FarmStatusOptions& options);

/// The same for a farm that has been read, as text for people or as JSON.
std::string status_text(const FarmFolder& farm, const FarmContent& content,
                        const std::vector<farm::FarmTask>& tasks, bool json);

}  // namespace orchard::cli
