// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/driver/driver.hpp"
#include "device/emulated/emulated_device.hpp"
#include "device/protocol.hpp"

namespace orchard::bus {

/// Serves an emulated device on a real TCP port or pseudo terminal, to which a driver connects. The
/// owner waits for its files and deadline, calls step(), and passes in the measurements.
class DeviceServer {
 public:
  using Clock = Driver::Clock;

  /// Opens the port. `where`: "tcp:127.0.0.1:10940" (port 0: any free one), or "pty:LINK" for a
  /// pseudo terminal with a symbolic link at that path ("pty:": without a link). Throws
  /// std::invalid_argument for anything else and std::system_error when it cannot be opened.
  DeviceServer(std::unique_ptr<device::EmulatedDevice> device, const std::string& where);
  ~DeviceServer();
  DeviceServer(const DeviceServer&) = delete;
  DeviceServer& operator=(const DeviceServer&) = delete;

  /// Address for a driver, in the notation of a rig: "tcp:127.0.0.1:40123", "serial:LINK".
  const std::string& address() const { return address_; }

  /// Time in the device's world [us]: the host's time of day at construction plus the time since
  /// then, without steps of the host's clock.
  std::int64_t now() const;

  std::vector<pollfd> files();
  Clock::time_point deadline();

  /// Reads and writes without blocking.
  void step();

  /// Passes a measurement to the device; its time refers to now().
  void measured(const device::Measurement& measurement) { device_->measured(measurement); }

  /// Disconnects and reconnects the cable.
  void unplug();
  void plug_in();

  /// Replaces the device behind the port, for example by the same one after a power cycle.
  void replace(std::unique_ptr<device::EmulatedDevice> device);

  bool has_client() const { return line_ >= 0 && !is_hung_up_; }

 private:
  void listen();
  void open_terminal();
  void accept_client();
  void watch_terminal();
  void read_line();
  void write_line();
  void drop_client();

  std::unique_ptr<device::EmulatedDevice> device_;
  bool is_tcp_ = false;
  std::string host_;
  int port_ = 0;
  std::string link_;
  std::string address_;
  std::int64_t start_utime_;
  Clock::time_point start_;
  int listener_ = -1;
  int line_ = -1;           ///< the client's socket, or the terminal's master side
  bool is_hung_up_ = true;  ///< terminal: nobody has it open
  std::string unsent_;
};

}  // namespace orchard::bus
