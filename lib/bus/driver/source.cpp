// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/source.hpp"

#include <algorithm>
#include <chrono>
#include <utility>
#include <variant>

#include "bus/messages/codec.hpp"
#include "io/file_error.hpp"

namespace orchard::bus {
namespace {

std::int64_t host_now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::int64_t first_timestamp(const std::string& log_path) {
  const std::optional<io::LogEvent> first = io::LogReader(log_path).next();
  if (!first) throw io::FileError(log_path + ": has no event; give a log with messages");
  return first->timestamp_us;
}

std::int64_t read_step(const std::string& bytes) {
  std::uint64_t step = 0;
  for (const char c : bytes.substr(0, 8)) step = step << 8 | static_cast<std::uint8_t>(c);
  return static_cast<std::int64_t>(step);
}

}  // namespace

void PacedSource::begin() {
  if (begun_) return;
  begun_ = true;
  next_ = source_->next();
  start_ = Clock::now();
}

Driver::Clock::time_point PacedSource::deadline() {
  begin();
  if (!next_) return Clock::time_point::max();
  const double due_us = static_cast<double>(since_first_us_) / speed_;
  return start_ + std::chrono::microseconds(static_cast<std::int64_t>(due_us));
}

void PacedSource::step(const Outbox& send) {
  if (deadline() > Clock::now() || !next_) return;
  send(*next_);
  const std::int64_t sent_utime = utime_of(*next_);
  next_ = source_->next();
  // Where a clock was set back, the next message follows at once.
  if (next_) since_first_us_ += std::max<std::int64_t>(utime_of(*next_) - sent_utime, 0);
}

PlayedLog::PlayedLog(const std::string& log_path, std::int64_t start_utime,
                     std::vector<Channel> channels)
    : log_(log_path), channels_(std::move(channels)) {
  shift_us_ = (start_utime > 0 ? start_utime : host_now()) - first_timestamp(log_path);
  find_next();
}

std::optional<Message> PlayedLog::take_due() {
  if (!next_ || host_now() < utime_of(*next_)) return std::nullopt;
  std::optional<Message> due = std::exchange(next_, std::nullopt);
  find_next();
  return due;
}

Driver::Clock::time_point PlayedLog::deadline() const {
  using Clock = Driver::Clock;
  if (!next_) return Clock::time_point::max();
  const std::int64_t wait_us = std::max<std::int64_t>(utime_of(*next_) - host_now(), 0);
  return Clock::now() + std::chrono::microseconds(wait_us);
}

void PlayedLog::find_next() {
  while (const std::optional<io::LogEvent> event = log_.next()) {
    const std::optional<Channel> channel = find_channel(event->channel);
    if (!channel || std::find(channels_.begin(), channels_.end(), *channel) == channels_.end()) {
      continue;
    }
    auto decoded = decode(*channel, event->data.data(), event->data.size());
    if (auto* message = std::get_if<Message>(&decoded)) {
      std::visit([this](auto& m) { m.utime += shift_us_; }, *message);
      next_ = std::move(*message);
      return;
    }
  }
}

RawSource::RawSource(std::unique_ptr<device::Protocol> protocol, const std::string& raw_path)
    : protocol_(std::move(protocol)), reader_(raw_path) {}

std::optional<Message> RawSource::next() {
  while (waiting_.empty()) {
    if (!feed()) return std::nullopt;
  }
  Message message = numbers_.number(std::move(waiting_.front()));
  waiting_.pop_front();
  return message;
}

bool RawSource::feed() {
  const std::optional<io::RawEvent> event = reader_.next();
  if (!event) return false;
  // Live, received bytes are processed before the deadline is checked: after a delay of the host
  // both can be due at once.
  const auto keep_deadline = [&] {
    const auto due = protocol_->deadline();
    if (due && *due <= event->utime) protocol_->expire(event->utime);
  };
  switch (event->kind) {
    case io::RawKind::kConnected:
      keep_deadline();
      protocol_->connected(event->utime);
      break;
    case io::RawKind::kReceived:
      protocol_->receive(event->bytes, event->utime);
      keep_deadline();
      break;
    case io::RawKind::kClockStepped:
      protocol_->host_clock_stepped(read_step(event->bytes));
      break;
    case io::RawKind::kSent:
      keep_deadline();
      break;
  }
  protocol_->take_to_send();
  for (device::Measurement& measurement : protocol_->take_measurements()) {
    waiting_.push_back(std::move(measurement));
  }
  return true;
}

}  // namespace orchard::bus
