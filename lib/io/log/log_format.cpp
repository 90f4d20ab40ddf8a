// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/log_format.hpp"

#include <algorithm>

namespace orchard::io {
namespace {

template <class Unsigned>
Unsigned get(const std::uint8_t* bytes) {
  Unsigned value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
    value = static_cast<Unsigned>(value << 8 | bytes[i]);
  }
  return value;
}

template <class Unsigned>
void put(Unsigned value, std::uint8_t* bytes) {
  for (std::size_t i = sizeof(Unsigned); i-- > 0; value = static_cast<Unsigned>(value >> 8)) {
    bytes[i] = static_cast<std::uint8_t>(value);
  }
}

}  // namespace

LogEventHeader parse_log_event_header(const std::uint8_t* bytes) {
  LogEventHeader header;
  header.sync = get<std::uint32_t>(bytes);
  header.event_number = static_cast<std::int64_t>(get<std::uint64_t>(bytes + 4));
  header.timestamp_us = static_cast<std::int64_t>(get<std::uint64_t>(bytes + 12));
  header.channel_bytes = get<std::uint32_t>(bytes + 20);
  header.data_bytes = get<std::uint32_t>(bytes + 24);
  return header;
}

void put_log_event_header(const LogEventHeader& header, std::uint8_t* bytes) {
  put(header.sync, bytes);
  put(static_cast<std::uint64_t>(header.event_number), bytes + 4);
  put(static_cast<std::uint64_t>(header.timestamp_us), bytes + 12);
  put(header.channel_bytes, bytes + 20);
  put(header.data_bytes, bytes + 24);
}

bool is_channel_name(std::string_view text) {
  return !text.empty() && text.size() <= LogEventHeader::kMaxChannelBytes &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > 0x20 && c < 0x7F; });
}

void append_log_event(std::int64_t event_number, std::int64_t timestamp_us,
                      std::string_view channel, const std::uint8_t* data, std::size_t size,
                      std::vector<std::uint8_t>& buffer) {
  const LogEventHeader header{LogEventHeader::kSyncWord, event_number, timestamp_us,
                              static_cast<std::uint32_t>(channel.size()),
                              static_cast<std::uint32_t>(size)};
  std::uint8_t bytes[LogEventHeader::kBytes];
  put_log_event_header(header, bytes);
  buffer.insert(buffer.end(), bytes, bytes + sizeof(bytes));
  buffer.insert(buffer.end(), channel.begin(), channel.end());
  buffer.insert(buffer.end(), data, data + size);
}

}  // namespace orchard::io
