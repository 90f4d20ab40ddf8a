// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>

namespace orchard::bus {

/// Where a device is, as a person writes it.
struct PortAddress {
  enum class Kind { kSerial, kTcp };
  Kind kind = Kind::kSerial;
  std::string path;     ///< serial: "/dev/ttyACM0"
  int baud = 115200;    ///< serial; without meaning on USB and pseudo terminals
  std::string host;     ///< TCP: a numeric address or "localhost", so that nothing waits for DNS
  std::string service;  ///< TCP: the port's number
};

/// Reads "serial:/dev/ttyACM0", "serial:/dev/ttyUSB0:57600", "/dev/ttyACM0" or
/// "tcp:192.168.0.10:10940". Throws std::invalid_argument with what is wrong and what would be
/// right.
PortAddress parse_port(const std::string& text);

/// A byte stream to a device on a serial line or over TCP that comes back by itself: what cannot be
/// opened, ends or fails is opened again every half second. Nothing here blocks.
class Port {
 public:
  using Clock = std::chrono::steady_clock;

  enum class State { kClosed, kConnecting, kOpen };

  explicit Port(PortAddress address);
  ~Port();
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  /// Opens when it is time to, and completes what began. True when it has become open just now.
  bool poll_connection();

  /// Appends what is there to be read to `bytes`, at most 64 KiB; closes when the other end did.
  void read_into(std::string& bytes);

  /// Sends `bytes`, keeping for later what does not go out at once; closes when nobody takes it.
  void write(std::string_view bytes);

  /// Closes and says why; opens again after half a second.
  void close(const std::string& reason);

  State state() const { return state_; }
  int fileno() const { return fileno_; }
  bool has_unsent() const { return !unsent_.empty(); }

  /// When poll_connection() has something to do; only while not open.
  Clock::time_point next_attempt() const { return next_attempt_; }

  /// Why it is not open, in words for a person.
  const std::string& problem() const { return problem_; }

  /// "serial:/dev/ttyACM0" or "tcp:192.168.0.10:10940".
  std::string name() const;

 private:
  void open_serial();
  void begin_tcp();
  bool finish_tcp();

  PortAddress address_;
  State state_ = State::kClosed;
  int fileno_ = -1;
  std::string unsent_;
  std::string problem_;
  Clock::time_point next_attempt_ = Clock::now();
};

}  // namespace orchard::bus
