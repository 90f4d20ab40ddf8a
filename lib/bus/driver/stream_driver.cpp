// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/stream_driver.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

namespace orchard::bus {

Message MessageNumbers::number(device::Measurement measurement) {
  Message message =
      std::visit([](auto&& m) { return Message(std::move(m)); }, std::move(measurement));
  std::int32_t& next = next_seq_[static_cast<std::size_t>(channel_of(message))];
  std::visit([&next](auto& m) { m.seq = next++; }, message);
  return message;
}

StreamDriver::StreamDriver(std::unique_ptr<device::Protocol> protocol, PortAddress address,
                           const std::string& raw_path)
    : protocol_(std::move(protocol)), port_(std::move(address)) {
  if (!raw_path.empty()) raw_ = std::make_unique<io::RawBytesWriter>(raw_path);
}

std::vector<pollfd> StreamDriver::files() {
  switch (port_.state()) {
    case Port::State::kOpen:
      return {{port_.fileno(), static_cast<short>(POLLIN | (port_.has_unsent() ? POLLOUT : 0)), 0}};
    case Port::State::kConnecting:
      return {{port_.fileno(), POLLOUT, 0}};
    default:
      return {};
  }
}

Driver::Clock::time_point StreamDriver::deadline() {
  if (port_.state() != Port::State::kOpen) return port_.next_attempt();
  const auto due = protocol_->deadline();
  if (!due) return Clock::time_point::max();
  return Clock::now() + std::chrono::microseconds(std::max<std::int64_t>(0, *due - clock_.now()));
}

void StreamDriver::step(const Outbox& send) {
  std::int64_t host_utime = clock_.now();
  note_clock_step(host_utime);
  const Port::State before = port_.state();
  if (port_.poll_connection()) {
    spdlog::info("connected to {}", port_.name());
    record(io::RawKind::kConnected, {}, host_utime);
    protocol_->connected(host_utime);
  }
  std::string bytes;
  port_.read_into(bytes);
  if (!bytes.empty()) {
    record(io::RawKind::kReceived, bytes, host_utime);
    protocol_->receive(bytes, host_utime);
  }
  if (port_.state() == Port::State::kOpen) {
    expire_when_due(host_utime);
    const std::string to_send = protocol_->take_to_send();
    if (!to_send.empty()) record(io::RawKind::kSent, to_send, host_utime);
    port_.write(to_send);
    if (const std::string failure = protocol_->failure(); !failure.empty()) {
      port_.close(port_.name() + ": " + failure);
    }
  }
  if (before == Port::State::kOpen && port_.state() == Port::State::kClosed) {
    spdlog::warn("{}; reconnecting", port_.problem());
  }
  for (device::Measurement& measurement : protocol_->take_measurements()) {
    send(numbers_.number(std::move(measurement)));
  }
}

void StreamDriver::note_clock_step(std::int64_t host_utime) {
  const std::int64_t step_us = clock_.take_step();
  if (step_us == 0) return;
  spdlog::warn("the clock of this machine was changed by {:+.3f} s",
               1e-6 * static_cast<double>(step_us));
  std::string bytes(8, '\0');
  for (std::size_t i = 0; i < 8; ++i) {
    bytes[i] = static_cast<char>(static_cast<std::uint64_t>(step_us) >> (56 - 8 * i));
  }
  record(io::RawKind::kClockStepped, std::move(bytes), host_utime);
  protocol_->host_clock_stepped(step_us);
}

void StreamDriver::expire_when_due(std::int64_t host_utime) {
  const auto due = protocol_->deadline();
  if (due && *due <= host_utime) protocol_->expire(host_utime);
}

void StreamDriver::record(io::RawKind kind, std::string bytes, std::int64_t host_utime) {
  if (!raw_) return;
  try {
    raw_->write({host_utime, kind, std::move(bytes)});
  } catch (const std::exception& error) {
    // The measurements matter more than the recording: the driver continues and reports it.
    raw_problem_ = std::string("raw bytes are no longer recorded: ") + error.what();
    spdlog::error("{}", raw_problem_);
    raw_.reset();
  }
}

DriverCondition StreamDriver::condition() const {
  DriverCondition condition;
  condition.num_bad = protocol_->counts().num_bad;
  if (port_.state() != Port::State::kOpen) {
    condition.level = Level::kError;
    condition.text = port_.problem().empty() ? "connecting to " + port_.name()
                                             : port_.problem() + "; retrying every 0.5 s";
  } else {
    const device::Condition said = protocol_->condition();
    condition.level = static_cast<Level>(said.severity);
    condition.text = said.text;
    if (said.severity == device::Severity::kError && !port_.stranger().empty()) {
      condition.text += "; " + port_.stranger() + " sends to this port too, and " + port_.name() +
                        " leaves it out";
    }
  }
  if (!raw_problem_.empty()) {
    condition.level = std::max(condition.level, Level::kWarning);
    condition.text += (condition.text.empty() ? "" : "; ") + raw_problem_;
  }
  return condition;
}

}  // namespace orchard::bus
