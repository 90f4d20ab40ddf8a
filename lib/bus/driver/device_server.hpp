// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <poll.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bus/driver/driver.hpp"
#include "device/protocol.hpp"
#include "simulation/device/emulated_device.hpp"

namespace orchard::bus {

/// An emulated device on a real TCP port or pseudo terminal, for a driver to connect to. Whoever
/// owns it waits for its files and deadline, and tells it what the device measures.
class DeviceServer {
 public:
  using Clock = Driver::Clock;

  /// `where`: "tcp:127.0.0.1:10940" (port 0: any that is free), or "pty:LINK" for a pseudo terminal
  /// behind a symbolic link at that path ("pty:": behind none). Throws std::invalid_argument for
  /// anything else, std::system_error when it cannot be had.
  DeviceServer(std::unique_ptr<simulation::EmulatedDevice> device, const std::string& where);
  ~DeviceServer();
  DeviceServer(const DeviceServer&) = delete;
  DeviceServer& operator=(const DeviceServer&) = delete;

  /// Where a driver finds it, as a rig has it: "tcp:127.0.0.1:40123", "serial:LINK".
  const std::string& address() const { return address_; }

  /// Time as the device's world has it [us]: the host's time of day when this was made, counted on
  /// without its steps.
  std::int64_t now() const;

  std::vector<pollfd> files();
  Clock::time_point deadline();

  /// Reads and writes what can be without waiting.
  void step();

  /// The device has measured this, at a time of now().
  void measured(const device::Measurement& measurement) { device_->measured(measurement); }

  /// Pulls the cable out, and puts it in again.
  void unplug();
  void plug_in();

  /// Another device at the same place, such as the same one after it was switched off.
  void replace(std::unique_ptr<simulation::EmulatedDevice> device);

  bool has_client() const { return line_ >= 0 && !is_hung_up_; }

 private:
  void listen();
  void open_terminal();
  void accept_client();
  void watch_terminal();
  void read_line();
  void write_line();
  void drop_client();

  std::unique_ptr<simulation::EmulatedDevice> device_;
  bool is_tcp_ = false;
  std::string host_;
  int port_ = 0;
  std::string link_;
  std::string address_;
  std::int64_t start_utime_;
  Clock::time_point start_;
  int listener_ = -1;
  int line_ = -1;           ///< the client's socket, or the terminal's master side
  bool is_hung_up_ = true;  ///< of a terminal: nobody has it open
  std::string unsent_;
};

}  // namespace orchard::bus
