// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>

#include "bus/driver/driver.hpp"
#include "bus/driver/source.hpp"
#include "bus/node/node.hpp"
#include "bus/node/process_info.hpp"
#include "io/config/config_file.hpp"

namespace orchard::bus {

/// Runs one node as a process: parses the options, loads the configuration, opens the bus, passes
/// validated messages to the node, publishes its outputs, STATUS and CONFIG, and flushes the node
/// on SIGINT or SIGTERM. `make_node` is called after `config` is loaded. Prints every error as one
/// sentence and returns the exit code.
int run_node_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                     const std::function<std::unique_ptr<Node>()>& make_node,
                     const SaveHook& save = {});

/// Runs a source as a process in the same way, publishing its messages at their pace (--speed).
int run_driver_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Source>()>& make_source);

/// Runs a device driver as a process in the same way, at the device's pace. `make_driver` may throw
/// io::ConfigError, io::FileError and std::invalid_argument (an invalid option).
int run_device_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<std::unique_ptr<Driver>()>& make_driver);

}  // namespace orchard::bus
