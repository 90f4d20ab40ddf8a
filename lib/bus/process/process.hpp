// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/driver/driver.hpp"
#include "bus/driver/source.hpp"
#include "bus/messages/channel.hpp"
#include "bus/node/node.hpp"
#include "bus/node/process_options.hpp"
#include "device/emulated/emulated_device.hpp"
#include "device/protocol.hpp"
#include "io/config/config_file.hpp"

namespace orchard::bus {

/// Runs the body of a program; prints an exception as one sentence and returns the exit code for
/// it.
int run_guarded(const std::string& name, const std::function<int()>& body);

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

/// Parses the value of an option, a time of this machine [us]; empty: 0. Throws
/// std::invalid_argument.
std::int64_t parse_utime(const std::string& option, const std::string& text);

/// Describes the driver of a device with a byte protocol; built once the rig is loaded.
struct StreamDevice {
  std::function<std::unique_ptr<device::Protocol>()> make_protocol;
  std::string device;    ///< address from the configuration
  bool is_rear = false;  ///< its scans are published on SCAN.rear (second scanner)

  // Emulation for use without the device: --emulate.
  std::function<std::unique_ptr<device::EmulatedDevice>()> make_emulated;
  std::string emulated_at;        ///< "pty:" or "tcp:127.0.0.1:0"
  std::vector<Channel> channels;  ///< channels of the log that the emulated device plays
};

/// Runs the driver of a device with a byte protocol as a process. Additional options: --device,
/// --raw-out and --raw-in (raw bytes to and from a file), --emulate and --emulate-at.
int run_stream_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<StreamDevice()>& make_device);

}  // namespace orchard::bus
