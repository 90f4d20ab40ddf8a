// SPDX-License-Identifier: BSD-3-Clause
#include "bus/replay/replay_index.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "bus/node/sequence_gate.hpp"
#include "bus/replay/arrival_delays.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"

namespace orchard::bus {
namespace {

/// Whether the name is that of an additional sensor of a known kind, such as "IMAGE.left".
bool is_second_sensor(const std::string& channel) {
  const std::size_t dot = channel.find('.');
  if (dot == std::string::npos) return false;
  const std::optional<Channel> kind = find_channel(channel.substr(0, dot));
  return kind && info(*kind).role == Role::kSource;
}

/// Adds one sentence per problem that the gate found on a channel.
void add_warnings(ReplayReport& report, Channel channel, const SequenceCounts& counts) {
  const std::string name(info(channel).name);
  if (counts.num_jumps > 0) {
    report.warnings.push_back(std::to_string(counts.num_jumps) + " " + name +
                              " messages jump in time or seq and were ignored");
  }
  if (counts.clock_change_s != 0.0) {
    report.warnings.push_back("the clock of the sender of " + name + " was changed by " +
                              fixed_text(counts.clock_change_s, 1) + " s");
  }
  if (counts.num_second_source_signs > 2) {
    report.warnings.push_back(name +
                              " is sent by two sources, or by one that restarts again and again");
  }
}

void add_warnings(ReplayReport& report, const SequenceGate& gate) {
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
                              " messages are missing (gaps in seq)");
  }
  for (const ChannelInfo& channel : kChannels) {
    add_warnings(report, channel.channel, gate.counts(channel.channel));
  }
}

/// Collects the messages accepted by the gate and those it holds.
class Gathered {
 public:
  /// `recorded_utime`: time of arrival according to the log [us].
  void add(const ReplayEntry& entry, std::int64_t recorded_utime) {
    std::vector<ReplayEntry>& held = held_[static_cast<std::size_t>(entry.channel)];
    const GateDecision decision =
        gate_.accept(entry.channel, entry.seq, entry.utime, recorded_utime);
    if (decision == GateDecision::kDuplicate) return;
    if (decision == GateDecision::kHeld) {
      held.push_back(entry);
      const auto num_held = static_cast<std::size_t>(gate_.num_held(entry.channel));
      held.erase(held.begin(), held.end() - static_cast<std::ptrdiff_t>(num_held));
      return;
    }
    if (decision == GateDecision::kConfirmed) {
      for (const ReplayEntry& other : held) take(other);
    }
    if (decision != GateDecision::kReordered) held.clear();
    take(entry);
  }

  /// Removes runs at a source's beginning that are too short to be confirmed and that the source's
  /// later time contradicts: the first message of a log may be an outlier. Returns the number of
  /// messages removed.
  std::int64_t finish() {
    gate_.finish();
    std::map<Run, std::pair<int, std::int64_t>> runs;  // count and last utime
    for (const Taken& taken : taken_) {
      auto& [num, utime] = runs[run_of(taken)];
      ++num;
      utime = taken.entry.utime;
    }
    const auto is_contradicted = [&](const Taken& taken) {
      const Run run = run_of(taken);
      const auto [num, utime] = runs.at(run);
      const auto next = runs.find({run.first, run.second + 1});
      return num < SequenceGate::kNumToConfirm && next != runs.end() &&
             std::abs(next->second.second - utime) > SequenceGate::kJump_us;
    };
    const std::size_t num_before = taken_.size();
    taken_.erase(std::remove_if(taken_.begin(), taken_.end(), is_contradicted), taken_.end());
    return static_cast<std::int64_t>(num_before - taken_.size());
  }

  /// Calls visit(entry) for each entry in replay order and frees it.
  template <class Visit>
  void hand_over(Visit&& visit) {
    std::sort(taken_.begin(), taken_.end(), [](const Taken& one, const Taken& other) {
      const ReplayEntry &a = one.entry, &b = other.entry;
      return std::tie(a.utime, a.channel, a.seq, a.offset) <
             std::tie(b.utime, b.channel, b.seq, b.offset);
    });
    for (; !taken_.empty(); taken_.pop_front()) visit(taken_.front().entry);
  }

  const SequenceGate& gate() const { return gate_; }

 private:
  using Run = std::pair<Channel, std::int32_t>;
  struct Taken {
    ReplayEntry entry;
    std::int32_t run = 0;
  };
  static Run run_of(const Taken& taken) { return {taken.entry.channel, taken.run}; }
  void take(const ReplayEntry& entry) { taken_.push_back({entry, gate_.run(entry.channel)}); }

  std::deque<Taken> taken_;  ///< a deque: memory is taken and given back piece by piece
  SequenceGate gate_;
  std::array<std::vector<ReplayEntry>, kNumChannels> held_;
};

/// Keeps the entries within the requested time window after the first message.
void put_in_order(Gathered& gathered, const ReplayOptions& options, ReplayIndex& index) {
  std::optional<std::int64_t> first;
  std::int64_t last = 0;
  gathered.hand_over([&](const ReplayEntry& entry) {
    if (!first) first = entry.utime;
    const double t_s = static_cast<double>(entry.utime - *first) * 1e-6;
    if (t_s < options.from_s || t_s > options.to_s) return;
    if (index.entries.empty()) index.report.first_utime = entry.utime;
    last = entry.utime;
    index.entries.push_back(entry);
  });
  index.report.last_utime = last;
  index.entries.shrink_to_fit();
}

}  // namespace

ReplayIndex index_log(const io::LogPaths& logs, const ReplayOptions& options) {
  const std::string log_path = logs.text();
  ReplayIndex index;
  ReplayReport& report = index.report;
  io::LogSeries reader(logs);
  Gathered gathered;
  ArrivalDelays delays;
  std::set<std::string> other_channels;
  std::set<std::string> second_sensors;
  bool has_source = false;
  while (const std::optional<io::LogEvent> event = reader.next()) {
    if (options.check) options.check();
    const std::optional<Channel> channel = find_channel(event->channel);
    if (!channel) {
      ++report.num_unknown_channel;
      if (is_second_sensor(event->channel) && second_sensors.size() < 20) {
        second_sensors.insert(event->channel);
      }
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
        throw io::FileError(reader.where(event->offset) + ": this message of " + event->channel +
                            " is invalid: " + rejection->detail);
      }
      ++report.num_rejected[static_cast<std::size_t>(rejection->reason)];
      continue;
    }
    const Message& message = std::get<Message>(decoded);
    delays.add(*channel, utime_of(message), event->timestamp_us);
    gathered.add({utime_of(message), *channel, seq_of(message), event->offset},
                 event->timestamp_us);
  }
  const std::int64_t num_contradicted = gathered.finish();
  report.num_events = reader.num_events();
  report.gaps = reader.gaps();
  const SequenceCounts counts = gathered.gate().counts();
  report.num_duplicates = counts.num_duplicate;
  report.num_seq_gaps = counts.num_lost;
  if (report.num_events == 0) {
    throw io::FileError(log_path + ": no readable LCM event; give an LCM log");
  }
  if (!has_source) {
    throw io::FileError(
        fmt::format("{}: has no channel to replay (SCAN, IMAGE, ODOMETRY, GNSS, POSE_FIX), only {}",
                    log_path, fmt::join(other_channels, ", ")));
  }
  if (options.strict && !report.gaps.empty()) {
    throw io::FileError(
        log_path + ": damaged at offset " + std::to_string(report.gaps.front().offset) + " (" +
        std::to_string(report.gaps.front().size) +
        " bytes could not be read); copy the readable messages with \"orchard log repair\"");
  }
  report.warnings = reader.notes();
  add_warnings(report, gathered.gate());
  if (!second_sensors.empty()) {
    report.warnings.push_back(fmt::format(
        "{}: not used; a second sensor is supported only for {} ({})",
        fmt::join(second_sensors, ", "), info(Channel::kScan).name, info(Channel::kScanRear).name));
  }
  for (std::string& warning : delays.warnings()) report.warnings.push_back(std::move(warning));
  if (num_contradicted > 0) {
    report.warnings.push_back(std::to_string(num_contradicted) +
                              " messages at the start of a channel were ignored: their time does "
                              "not fit the messages after them");
  }
  put_in_order(gathered, options, index);
  if (index.entries.empty()) {
    throw io::FileError(log_path + ": no valid sensor message" +
                        (report.warnings.empty() ? "" : " (" + report.warnings.front() + ")"));
  }
  return index;
}

}  // namespace orchard::bus
