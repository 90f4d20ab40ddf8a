// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/played_log.hpp"

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

}  // namespace

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

}  // namespace orchard::bus
