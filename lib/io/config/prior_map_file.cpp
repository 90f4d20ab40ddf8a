// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/prior_map_file.hpp"

#include <filesystem>

#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"

namespace orchard::io {

std::vector<pose::PriorLandmark> read_prior_map(const pose::PriorMapConfig& config) {
  std::string path = config.map_file;
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) path += "/map.csv";
  std::vector<pose::PriorLandmark> landmarks;
  for (const mapping::Landmark& l : read_map_csv(path)) {
    if (l.num_observations < config.min_observations) continue;
    landmarks.push_back({{l.x_m, l.y_m}, l.width_m, static_cast<double>(l.num_observations)});
  }
  const std::string problem = pose::problem_with(landmarks);
  if (!problem.empty()) {
    throw FileError(path + " (pose.prior_map.map_file) is no map to find a place in: it " +
                    problem);
  }
  return landmarks;
}

}  // namespace orchard::io
