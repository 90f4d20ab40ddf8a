// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/service_messages.hpp"

#include "bus/messages/field_codec.hpp"

namespace orchard::bus {

std::vector<std::uint8_t> encode(const Status& status) {
  return encode_fields(Channel::kStatus, status);
}
std::vector<std::uint8_t> encode(const ConfigNotice& notice) {
  return encode_fields(Channel::kConfig, notice);
}
std::vector<std::uint8_t> encode(const Ack& ack) { return encode_fields(Channel::kAck, ack); }
std::vector<std::uint8_t> encode(const ReplayMark& mark) {
  return encode_fields(Channel::kReplay, mark);
}

std::variant<Status, Rejection> decode_status(const void* data, std::size_t size) {
  return decode_fields<Status>(Channel::kStatus, data, size, StatusFields{});
}
std::variant<ConfigNotice, Rejection> decode_config(const void* data, std::size_t size) {
  return decode_fields<ConfigNotice>(Channel::kConfig, data, size, ConfigNoticeFields{});
}
std::variant<Ack, Rejection> decode_ack(const void* data, std::size_t size) {
  return decode_fields<Ack>(Channel::kAck, data, size, AckFields{});
}
std::variant<ReplayMark, Rejection> decode_replay(const void* data, std::size_t size) {
  return decode_fields<ReplayMark>(Channel::kReplay, data, size, ReplayMarkFields{});
}

}  // namespace orchard::bus
