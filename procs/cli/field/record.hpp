// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

struct RecordOptions {
  std::string lcm_url;
  std::string config_path;
  std::string folder = "out/recordings";
  std::string name = "drive";
  double split_mb = 500.0;
  double keep_gb = 0.0;
  double least_free_gb = 1.0;
};

/// Records every channel until Ctrl-C and sends STATUS as orchard-recorder.
int run_record(const RecordOptions& options);

}  // namespace orchard::cli
