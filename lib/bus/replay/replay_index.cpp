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

#include "bus/network.hpp"
#include "bus/node/gated.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"
#include "timing/units.hpp"

namespace orchard::bus {
namespace {

/// Seven bits a byte, the lowest first; differences of either sign are small numbers.
void put(std::uint64_t value, std::vector<std::uint8_t>& bytes) {
  for (; value >= 0x80; value >>= 7) bytes.push_back(static_cast<std::uint8_t>(value | 0x80));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

std::uint64_t get(const std::vector<std::uint8_t>& bytes, std::size_t& at) {
  std::uint64_t value = 0;
  for (int shift = 0;; shift += 7) {
    const std::uint8_t byte = bytes[at++];
    value |= std::uint64_t{byte & 0x7Fu} << shift;
    if (byte < 0x80) return value;
  }
}

/// Modulo 2^64, so that any two values have a difference.
std::uint64_t folded(std::uint64_t now, std::uint64_t before) {
  const std::uint64_t change = now - before;
  return (change << 1) ^ (0 - (change >> 63));
}
std::uint64_t unfolded(std::uint64_t folded_change, std::uint64_t before) {
  return before + ((folded_change >> 1) ^ (0 - (folded_change & 1)));
}

constexpr std::size_t kSamplesMax = 4096;
constexpr std::size_t kSamplesMin = 20;

/// Max interquartile range of a channel's delays. A larger one means that the log was not recorded
/// in real time: it was played faster, or its times are artificial.
constexpr std::int64_t kSteady_us = 100'000;

/// No message is recorded before its measurement; clocks synchronized over a network agree to this.
constexpr std::int64_t kBefore_us = 50'000;

/// Larger than the delays of a sweep, an exposure, compression and a wireless network together.
constexpr std::int64_t kApart_us = 300'000;

/// Channels that publish without delay; GNSS and POSE_FIX do not.
constexpr std::array<Channel, 5> kPrompt = {Channel::kScan, Channel::kScanRear, Channel::kImage,
                                            Channel::kOdometry, Channel::kImu};

std::int64_t quantile(std::vector<std::int64_t> values, double fraction) {
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::string seconds_text(std::int64_t us) { return fixed_text(1e-6 * static_cast<double>(us), 2); }

struct Delay {
  Channel channel;
  std::int64_t median_us;
};

std::string names_of(const std::vector<Delay>& delays) {
  std::string text;
  for (const Delay& delay : delays) {
    text += (text.empty() ? "" : ", ") + std::string(info(delay.channel).name);
  }
  return text;
}

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
                              " places could not be read, the first in " +
                              io::LogPaths(report.gaps.front().log).names() + " at offset " +
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
  /// `entry` has its utime. `recorded_utime`: time of arrival according to the log [us].
  void add(const ReplayEntry& entry, std::int64_t recorded_utime) {
    for (auto& [drive_time, used] :
         gated_.add(entry.channel, entry.seq, entry.drive_time, recorded_utime, entry)) {
      used.drive_time = drive_time;
      taken_.push_back({used, gated_.gate().run(used.channel)});
    }
  }

  /// Removes runs at a source's beginning that are too short to be confirmed and that the source's
  /// later time contradicts: the first message of a log may be an outlier. Returns the number of
  /// messages removed.
  std::int64_t finish() {
    gated_.gate().finish();
    std::map<Run, std::pair<int, std::int64_t>> runs;  // count and last utime
    for (const Taken& taken : taken_) {
      auto& [num, utime] = runs[run_of(taken)];
      ++num;
      utime = timing::utime_of(taken.entry.drive_time);
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
      return std::tie(a.drive_time, a.channel, a.seq, a.offset) <
             std::tie(b.drive_time, b.channel, b.seq, b.offset);
    });
    for (; !taken_.empty(); taken_.pop_front()) visit(taken_.front().entry);
  }

  const SequenceGate& gate() const { return gated_.gate(); }

 private:
  using Run = std::pair<Channel, std::int32_t>;
  struct Taken {
    ReplayEntry entry;
    std::int32_t run = 0;
  };
  static Run run_of(const Taken& taken) { return {taken.entry.channel, taken.run}; }

  std::deque<Taken> taken_;  ///< a deque: memory is taken and given back piece by piece
  Gated<ReplayEntry> gated_;
};

/// Keeps the entries within the requested time window after the first message.
void put_in_order(Gathered& gathered, const ReplayOptions& options, ReplayIndex& index) {
  std::optional<std::int64_t> last;
  std::int64_t since_first_us = 0, first_us = 0;
  gathered.hand_over([&](const ReplayEntry& entry) {
    since_first_us += timing::elapsed_us(last.value_or(entry.drive_time), entry.drive_time);
    last = entry.drive_time;
    const double t_s = timing::seconds(since_first_us);
    if (t_s < options.from_s || t_s > options.to_s) return;
    if (index.entries.empty()) {
      index.report.first_utime = timing::utime_of(entry.drive_time);
      first_us = since_first_us;
    }
    index.report.last_utime = index.report.first_utime + since_first_us - first_us;
    index.entries.push_back(entry);
  });
  index.entries.shrink_to_fit();
}

}  // namespace

void ReplayEntries::push_back(const ReplayEntry& entry) {
  std::int32_t& seq = last_.seq[static_cast<std::size_t>(entry.channel)];
  bytes_.push_back(static_cast<std::uint8_t>(entry.channel));
  put(folded(static_cast<std::uint64_t>(entry.drive_time),
             static_cast<std::uint64_t>(last_.drive_time)),
      bytes_);
  put(folded(static_cast<std::uint64_t>(entry.seq), static_cast<std::uint64_t>(seq)), bytes_);
  put(folded(entry.offset, last_.offset), bytes_);
  last_.drive_time = entry.drive_time;
  last_.offset = entry.offset;
  seq = entry.seq;
  ++size_;
}

void ReplayEntries::Iterator::read() {
  if (at_ == bytes_->size()) return;
  next_ = at_;
  entry_.channel = static_cast<Channel>((*bytes_)[next_++]);
  std::int32_t& seq = last_.seq[static_cast<std::size_t>(entry_.channel)];
  last_.drive_time = static_cast<std::int64_t>(
      unfolded(get(*bytes_, next_), static_cast<std::uint64_t>(last_.drive_time)));
  seq = static_cast<std::int32_t>(unfolded(get(*bytes_, next_), static_cast<std::uint64_t>(seq)));
  last_.offset = unfolded(get(*bytes_, next_), last_.offset);
  entry_.drive_time = last_.drive_time;
  entry_.seq = seq;
  entry_.offset = last_.offset;
}

ReplayEntries::Iterator ReplayEntries::begin() const {
  Iterator first(bytes_, 0);
  first.read();
  return first;
}

ReplayEntries::Iterator& ReplayEntries::Iterator::operator++() {
  at_ = next_;
  read();
  return *this;
}

void ArrivalDelays::add(Channel channel, std::int64_t utime, std::int64_t recorded_utime) {
  if (std::find(kPrompt.begin(), kPrompt.end(), channel) == kPrompt.end()) return;
  Sample& sample = samples_[static_cast<std::size_t>(channel)];
  if (sample.num++ % sample.every != 0) return;
  sample.delays_us.push_back(recorded_utime - utime);
  if (sample.delays_us.size() < kSamplesMax) return;
  sample.every *= 2;
  for (std::size_t i = 1; 2 * i < sample.delays_us.size(); ++i) {
    sample.delays_us[i] = sample.delays_us[2 * i];
  }
  sample.delays_us.resize(sample.delays_us.size() / 2);
}

std::vector<std::string> ArrivalDelays::warnings() const {
  std::vector<Delay> delays;
  for (const Channel channel : kPrompt) {
    const std::vector<std::int64_t>& all = samples_[static_cast<std::size_t>(channel)].delays_us;
    if (all.size() < kSamplesMin) continue;
    if (quantile(all, 0.75) - quantile(all, 0.25) > kSteady_us) continue;
    delays.push_back({channel, quantile(all, 0.5)});
  }
  if (delays.size() < 2) return {};
  std::stable_sort(delays.begin(), delays.end(),
                   [](const Delay& a, const Delay& b) { return a.median_us < b.median_us; });
  const std::int64_t least_us = delays.front().median_us, most_us = delays.back().median_us;
  const bool some_are_ahead = least_us < -kBefore_us && most_us >= -kBefore_us;
  if (!some_are_ahead && most_us - least_us <= kApart_us) return {};
  const std::int64_t limit_us = some_are_ahead ? -kBefore_us : least_us + kApart_us;
  const auto split = std::partition_point(delays.begin(), delays.end(),
                                          [&](const Delay& d) { return d.median_us < limit_us; });
  const std::vector<Delay> early(delays.begin(), split), late(split, delays.end());
  const std::string by = seconds_text(most_us - least_us) + " s";
  if (some_are_ahead) {
    return {"the clock of the sender of " + names_of(early) + " is " + by + " ahead of that of " +
            names_of(late) +
            ": messages were logged before their own time stamp. Positions are wrong by the "
            "distance driven in that time; synchronise the clocks"};
  }
  return {names_of(late) + " was logged " + by + " later after its time stamp than " +
          names_of(early) + ": the clock of its sender is behind, or it was delayed"};
}

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
      require_no_robot(event->channel, log_path);
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
