// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate_probability.hpp"

#include "cli/calibrate/map_samples.hpp"
#include "cli/calibrate/write_probability.hpp"
#include "cli/evaluate/detection_log.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"

namespace orchard::cli {

int run_calibrate_probability(const CalibrateProbabilityOptions& options) {
  const io::Config config = io::load_config(options.config_path);
  const std::size_t num = options.map_folders.size();
  if (num != options.log_paths.size()) {
    throw io::FileError("there are " + std::to_string(options.log_paths.size()) + " logs and " +
                        std::to_string(num) + " maps; give one --map per log, in order");
  }
  std::vector<calibration::ProbabilitySample> samples;
  for (std::size_t i = 0; i < num; ++i) {
    const auto messages = detect_log(options.log_paths[i], config, !options.quiet);
    const auto more = map_samples(
        {options.log_paths[i], options.map_folders[i], options.ids, static_cast<int>(i)}, messages,
        config, options.quiet);
    samples.insert(samples.end(), more.begin(), more.end());
  }
  return write_probability(options, config, samples);
}

}  // namespace orchard::cli
