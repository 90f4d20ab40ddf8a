// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bus/driver/driver.hpp"
#include "bus/driver/stream_driver.hpp"
#include "bus/messages/message.hpp"
#include "device/protocol.hpp"
#include "io/log/log_reader.hpp"
#include "io/recording/raw_bytes.hpp"

namespace orchard::bus {

/// A sensor or an emulation of one: provides messages in order of utime. The host paces and
/// publishes them.
class Source {
 public:
  virtual ~Source() = default;

  /// Returns the next message, or none at the end.
  virtual std::optional<Message> next() = 0;

  /// Duration of all messages by their own time [s]; none when unknown.
  virtual std::optional<double> duration_s() const { return std::nullopt; }
};

/// Plays a source as a driver: sends each message at its time, relative to the first one.
class PacedSource : public Driver {
 public:
  /// `speed`: factor of real time, above 0.
  PacedSource(std::unique_ptr<Source> source, double speed)
      : source_(std::move(source)), speed_(speed) {}

  std::vector<pollfd> files() override { return {}; }
  Clock::time_point deadline() override;
  void step(const Outbox& send) override;
  bool ended() const override { return begun_ && !next_; }
  std::optional<double> duration_s() const override { return source_->duration_s(); }

 private:
  void begin();

  std::unique_ptr<Source> source_;
  double speed_;
  bool begun_ = false;
  std::optional<Message> next_;
  Clock::time_point start_;
  std::int64_t since_first_us_ = 0;  ///< of next_
};

/// Plays the messages of some channels of a log at their times, relative to the log's first event.
/// Several programs can therefore play one log together.
class PlayedLog {
 public:
  /// `start_utime`: host time at which the log's first event is played [us]; 0: now. Throws
  /// io::FileError.
  PlayedLog(const std::string& log_path, std::int64_t start_utime, std::vector<Channel> channels);

  /// Returns the next message if its time has come, with its utime shifted to the host's time.
  /// Skips messages that fail the checks of decode().
  std::optional<Message> take_due();

  /// Time at which the next message is due; time_point::max() if there is none.
  Driver::Clock::time_point deadline() const;

 private:
  void find_next();

  io::LogReader log_;
  std::vector<Channel> channels_;
  std::int64_t shift_us_ = 0;
  std::optional<Message> next_;
};

/// Replays a recording of a device's raw bytes through the same protocol as live, giving the same
/// measurements with the same stamps.
class RawSource : public Source {
 public:
  /// Throws io::FileError.
  RawSource(std::unique_ptr<device::Protocol> protocol, const std::string& raw_path);

  std::optional<Message> next() override;

 private:
  bool feed();

  std::unique_ptr<device::Protocol> protocol_;
  io::RawBytesReader reader_;
  std::deque<device::Measurement> waiting_;
  MessageNumbers numbers_;
};

}  // namespace orchard::bus
