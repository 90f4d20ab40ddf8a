// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/raw_source.hpp"

#include <utility>

namespace orchard::bus {
namespace {

std::int64_t read_step(const std::string& bytes) {
  std::uint64_t step = 0;
  for (const char c : bytes.substr(0, 8)) step = step << 8 | static_cast<std::uint8_t>(c);
  return static_cast<std::int64_t>(step);
}

}  // namespace

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
