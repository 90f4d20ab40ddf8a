// SPDX-License-Identifier: BSD-3-Clause
//
// The log reader must read any bytes to their end, and account for each of them: in an event or
// in a gap, in order.
#include <cstdlib>
#include <memory>
#include <sstream>

#include "fuzz/fuzz_seeds.hpp"
#include "io/log/log_format.hpp"
#include "io/log/log_reader.hpp"

using orchard::io::LogEvent;
using orchard::io::LogEventHeader;
using orchard::io::LogReader;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  LogReader reader(
      std::make_unique<std::istringstream>(std::string(reinterpret_cast<const char*>(data), size)),
      "fuzz");
  std::uint64_t num_bytes = 0;
  std::uint64_t end = 0;
  while (const auto event = reader.next()) {
    const std::uint64_t event_bytes =
        LogEventHeader::kBytes + event->channel.size() + event->data.size();
    if (event->offset < end) std::abort();
    end = event->offset + event_bytes;
    if (end != reader.position()) std::abort();
    num_bytes += event_bytes;
    const LogEvent again = reader.read_at(event->offset);
    if (again.channel != event->channel || again.data != event->data) std::abort();
  }
  for (const auto& gap : reader.gaps()) num_bytes += gap.size;
  if (num_bytes != size || reader.position() != size) std::abort();
  return 0;
}

namespace orchard::fuzz {

std::vector<std::string> seeds() {
  std::string log;
  for (int i = 0; i < 6; ++i) {
    const std::string channel = i % 2 == 0 ? "SCAN" : "ODOMETRY";
    const std::string data(static_cast<std::size_t>(8 + 20 * i), static_cast<char>(i));
    LogEventHeader header;
    header.sync = LogEventHeader::kSyncWord;
    header.event_number = i;
    header.timestamp_us = 1000000 + i;
    header.channel_bytes = static_cast<std::uint32_t>(channel.size());
    header.data_bytes = static_cast<std::uint32_t>(data.size());
    std::uint8_t bytes[LogEventHeader::kBytes];
    io::put_log_event_header(header, bytes);
    log.append(reinterpret_cast<const char*>(bytes), sizeof(bytes));
    log += channel + data;
  }
  return {"", log, log + log, log.substr(0, 50)};
}

}  // namespace orchard::fuzz
