// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>

namespace orchard::bus {

/// Address of a device, as written by the user.
struct PortAddress {
  enum class Kind { kSerial, kTcp, kUdp };
  Kind kind = Kind::kSerial;
  std::string path;   ///< serial: "/dev/ttyACM0"
  int baud = 115200;  ///< serial; no effect on USB and pseudo terminals
  /// TCP: numeric address or "localhost", to avoid waiting for DNS. UDP: the only sender that is
  /// listened to, in four numbers; empty: any.
  std::string host;
  std::string service;  ///< TCP: port number; UDP: that of this machine
};

/// Parses "serial:/dev/ttyACM0", "serial:/dev/ttyUSB0:57600", "/dev/ttyACM0",
/// "tcp:192.168.0.10:10940", "udp:2368" or "udp:192.168.1.201:2368". Throws std::invalid_argument
/// with the error and the correct form.
PortAddress parse_port(const std::string& text);

/// A byte stream to a device on a serial line or over TCP that reconnects by itself: after a
/// failure or the end of the stream it tries to open again every half second. Or datagrams that a
/// device sends by UDP to a port of this machine, to which nothing is written. No call blocks.
class Port {
 public:
  using Clock = std::chrono::steady_clock;

  enum class State { kClosed, kConnecting, kOpen };

  explicit Port(PortAddress address);
  ~Port();
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  /// Opens the port when an attempt is due, or completes a pending one. Returns true when the port
  /// has just become open.
  bool poll_connection();

  /// Appends the available bytes to `bytes`, at most 64 KiB; closes when the other end has closed.
  /// UDP: one datagram.
  void read_into(std::string& bytes);

  /// Sends `bytes` and buffers what cannot be sent at once; closes when the device does not read.
  void write(std::string_view bytes);

  /// Closes with a reason; reopens after half a second.
  void close(const std::string& reason);

  State state() const { return state_; }
  int fileno() const { return fileno_; }
  bool has_unsent() const { return !unsent_.empty(); }

  /// Time at which poll_connection() must be called next; only valid while not open.
  Clock::time_point next_attempt() const { return next_attempt_; }

  /// Why the port is not open, for the user.
  const std::string& problem() const { return problem_; }

  /// "serial:/dev/ttyACM0", "tcp:192.168.0.10:10940" or "udp:2368".
  std::string name() const;

  /// UDP: the last sender that was not listened to, for the user; empty: none.
  const std::string& stranger() const { return stranger_; }

 private:
  void open_serial();
  void begin_tcp();
  bool finish_tcp();
  void open_udp();
  void read_datagram(std::string& bytes);

  PortAddress address_;
  State state_ = State::kClosed;
  int fileno_ = -1;
  std::string unsent_;
  std::string problem_;
  std::string stranger_;
  Clock::time_point next_attempt_ = Clock::now();
};

}  // namespace orchard::bus
