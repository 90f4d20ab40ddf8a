// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/process/process.hpp"
#include "device/emulated/emulated_device.hpp"
#include "device/protocol.hpp"

namespace orchard::bus {

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
