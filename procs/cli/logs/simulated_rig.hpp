// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "cli/logs/simulate.hpp"
#include "io/config/config.hpp"
#include "io/log/log_writer.hpp"

namespace orchard::cli {

/// The rig of the options' file, or the scene's own. Throws io::ConfigError.
io::Config rig_of(const SimulateOptions& options);

/// Writes the CONFIG message at the start of a simulated log.
void write_rig(io::LogWriter& writer, const io::Config& config, std::int64_t utime);

}  // namespace orchard::cli
