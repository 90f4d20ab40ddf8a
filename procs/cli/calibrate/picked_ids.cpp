// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/picked_ids.hpp"

#include <algorithm>

#include "cli/calibrate/number_list.hpp"
#include "io/file_error.hpp"

namespace orchard::cli {

std::vector<int> picked_ids(const std::string& text,
                            const std::vector<mapping::Landmark>& landmarks,
                            const std::string& map_path) {
  std::vector<int> ids = parse_number_list(text, "--ids");
  std::string missing;
  for (const int id : ids) {
    const bool is_there = std::any_of(landmarks.begin(), landmarks.end(),
                                      [id](const auto& landmark) { return landmark.id == id; });
    if (!is_there) missing += (missing.empty() ? "" : ", ") + std::to_string(id);
  }
  if (missing.empty()) return ids;
  throw io::FileError(map_path + ": no landmark has id " + missing +
                      "; choose ids from the column id of this file");
}

}  // namespace orchard::cli
