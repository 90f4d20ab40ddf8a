// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "bus/messages/message.hpp"
#include "cli/logs/logs.hpp"
#include "io/config/config.hpp"

namespace orchard::cli {

/// The rig of the options' file, or the scene's own. Throws io::ConfigError.
io::Config rig_of(const SimulateOptions& options);

/// Writes the log of a simulated drive with its rig, from `begin_utime` to `end_utime` of the
/// messages that `next` gives, and prints their number. Throws io::FileError.
void write_simulated_log(const SimulateOptions& options, const io::Config& config,
                         std::int64_t begin_utime, std::int64_t end_utime,
                         const std::function<std::optional<bus::Message>()>& next);

}  // namespace orchard::cli
