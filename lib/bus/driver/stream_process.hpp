// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/node/process.hpp"
#include "device/protocol.hpp"
#include "simulation/device/emulated_device.hpp"

namespace orchard::bus {

/// A driver of a device that speaks in bytes, as a process makes it once the rig is loaded.
struct StreamDevice {
  std::function<std::unique_ptr<device::Protocol>()> make_protocol;
  std::string device;    ///< where it is, by the configuration
  bool is_rear = false;  ///< its scans are those of a robot's second scanner: SCAN.rear

  // What plays it, for people without the device: --emulate.
  std::function<std::unique_ptr<simulation::EmulatedDevice>()> make_emulated;
  std::string emulated_at;        ///< "pty:" or "tcp:127.0.0.1:0"
  std::vector<Channel> channels;  ///< of the log that it plays
};

/// Runs the driver of a device that speaks in bytes as a process. Beside the common options:
/// --device, --raw-out and --raw-in (raw bytes to and from a file), --emulate and --emulate-at.
int run_stream_process(int argc, char** argv, ProcessInfo info, io::ConfigFile& config,
                       const std::function<StreamDevice()>& make_device);

}  // namespace orchard::bus
