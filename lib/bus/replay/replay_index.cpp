// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/replay_index.hpp"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "bus/node/sequence_gate.hpp"
#include "io/file_error.hpp"

namespace orchard::bus {
namespace {

std::string join(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

void add_warnings(ReplayReport& report, const SequenceCounts& counts) {
  if (!report.gaps.empty()) {
    std::uint64_t num_bytes = 0;
    for (const io::LogGap& gap : report.gaps) num_bytes += gap.size;
    report.warnings.push_back("the log is damaged: " + std::to_string(num_bytes) + " bytes in " +
                              std::to_string(report.gaps.size()) +
                              " places could not be read, the first at offset " +
                              std::to_string(report.gaps.front().offset));
  }
  for (std::size_t i = 0; i < kNumReasons; ++i) {
    if (report.num_rejected[i] == 0) continue;
    report.warnings.push_back(std::to_string(report.num_rejected[i]) + " messages refused: " +
                              std::string(to_string(static_cast<Reason>(i))));
  }
  if (report.num_seq_gaps > 0) {
    report.warnings.push_back(std::to_string(report.num_seq_gaps) +
                              " messages are missing by their sequence numbers");
  }
  if (counts.num_backward > 0) {
    report.warnings.push_back(std::to_string(counts.num_backward) +
                              " messages go back in time and were left out");
  }
}

/// Keeps what lies within the asked-for seconds after the first message.
void cut(ReplayIndex& index, const ReplayOptions& options) {
  if (index.entries.empty()) return;
  const std::int64_t first = index.entries.front().utime;
  const auto outside = [&](const ReplayEntry& entry) {
    const double t_s = static_cast<double>(entry.utime - first) * 1e-6;
    return t_s < options.from_s || t_s > options.to_s;
  };
  index.entries.erase(std::remove_if(index.entries.begin(), index.entries.end(), outside),
                      index.entries.end());
}

}  // namespace

ReplayIndex index_log(const io::LogPaths& logs, const ReplayOptions& options) {
  const std::string log_path = logs.text();
  ReplayIndex index;
  ReplayReport& report = index.report;
  io::LogSeries reader(logs);
  SequenceGate gate;
  std::set<std::string> other_channels;
  bool has_source = false;
  while (const std::optional<io::LogEvent> event = reader.next()) {
    const std::optional<Channel> channel = find_channel(event->channel);
    if (!channel) {
      ++report.num_unknown_channel;
      if (other_channels.size() < 20) other_channels.insert(event->channel);
      continue;
    }
    if (info(*channel).role != Role::kSource) {
      if (other_channels.size() < 20) other_channels.insert(event->channel);
      continue;
    }
    has_source = true;
    const auto decoded = decode(*channel, event->data.data(), event->data.size());
    if (const auto* rejection = std::get_if<Rejection>(&decoded)) {
      if (options.strict) {
        throw io::FileError(reader.where(event->offset) + ": this " + event->channel +
                            " is refused: " + rejection->detail);
      }
      ++report.num_rejected[static_cast<std::size_t>(rejection->reason)];
      continue;
    }
    const Message& message = std::get<Message>(decoded);
    const std::int64_t utime = utime_of(message);
    const std::int32_t seq = seq_of(message);
    if (!gate.accept(*channel, seq, utime)) continue;
    index.entries.push_back({utime, *channel, seq, event->offset});
  }
  report.num_events = reader.num_events();
  report.gaps = reader.gaps();
  report.num_duplicates = gate.counts().num_duplicate;
  report.num_seq_gaps = gate.counts().num_lost;
  if (report.num_events == 0) {
    throw io::FileError(log_path + ": no readable LCM event in it; is it an LCM log?");
  }
  if (!has_source) {
    throw io::FileError(log_path +
                        ": holds no channel to replay (SCAN, IMAGE, ODOMETRY, GNSS, "
                        "POSE_FIX), only " +
                        join(other_channels));
  }
  if (options.strict && !report.gaps.empty()) {
    throw io::FileError(log_path + ": damaged at offset " +
                        std::to_string(report.gaps.front().offset) + " (" +
                        std::to_string(report.gaps.front().size) +
                        " bytes could not be read); \"orchard log repair\" keeps what is whole");
  }
  report.warnings = reader.notes();
  add_warnings(report, gate.counts());
  std::sort(index.entries.begin(), index.entries.end(),
            [](const ReplayEntry& a, const ReplayEntry& b) {
              return std::tie(a.utime, a.channel, a.seq, a.offset) <
                     std::tie(b.utime, b.channel, b.seq, b.offset);
            });
  cut(index, options);
  if (index.entries.empty()) {
    throw io::FileError(log_path + ": no usable source message in it" +
                        (report.warnings.empty() ? "" : " (" + report.warnings.front() + ")"));
  }
  report.first_utime = index.entries.front().utime;
  report.last_utime = index.entries.back().utime;
  return index;
}

}  // namespace orchard::bus
