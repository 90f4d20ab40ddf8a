// SPDX-License-Identifier: BSD-3-Clause
#include "io/log_check.hpp"

#include <filesystem>
#include <functional>

#include "io/file_error.hpp"
#include "io/log_writer.hpp"

namespace orchard::io {
namespace {

void count(const LogEvent& event, LogChannelSummary& channel) {
  if (channel.num_events == 0) channel.first_timestamp_us = event.timestamp_us;
  channel.last_timestamp_us = event.timestamp_us;
  ++channel.num_events;
  channel.num_bytes += static_cast<std::int64_t>(event.data.size());
}

LogSummary survey(const std::string& path, const std::function<void(const LogEvent&)>& sink) {
  LogReader reader(path);
  LogSummary summary;
  std::uint64_t next_number = 0;  // unsigned: damage may make it anything
  while (const auto event = reader.next()) {
    const auto number = static_cast<std::uint64_t>(event->event_number);
    if (summary.num_events > 0 && number != next_number) ++summary.num_number_jumps;
    next_number = number + 1;
    count(*event, summary.channels[event->channel]);
    ++summary.num_events;
    if (sink) sink(*event);
  }
  summary.file_size = reader.file_size();
  summary.gaps = reader.gaps();
  for (const LogGap& gap : summary.gaps) summary.num_lost_bytes += gap.size;
  return summary;
}

}  // namespace

LogSummary summarize_log(const std::string& path) { return survey(path, {}); }

LogSummary repair_log(const std::string& path, const std::string& out_path) {
  std::error_code ignored;
  if (std::filesystem::equivalent(path, out_path, ignored)) {
    throw FileError(out_path + " is the log to be repaired; give another name");
  }
  LogReader opens(path);  // before anything is made
  LogWriter writer(out_path);
  const LogSummary summary = survey(path, [&writer](const LogEvent& event) {
    writer.write(event.timestamp_us, event.channel, event.data);
  });
  if (summary.num_events == 0) {
    throw FileError(path + " holds no LCM event that can be read; is it an LCM log?");
  }
  writer.close();
  return summary;
}

}  // namespace orchard::io
