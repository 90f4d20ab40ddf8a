// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/logs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/network.hpp"
#include "bus/node/sequence_gate.hpp"
#include "bus/process/process.hpp"
#include "bus/replay/logged_rig.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/paths.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/log/log_series.hpp"
#include "io/log/log_writer.hpp"
#include "io/progress_bar.hpp"
#include "timing/units.hpp"

namespace orchard::cli {
namespace {

/// Content of one channel of a log.
struct ChannelSurvey {
  std::int64_t num_messages = 0;
  std::int64_t num_bytes = 0;
  std::int64_t num_refused = 0;     ///< rejected by the guard; known channels only
  std::int64_t num_duplicates = 0;  ///< this and the next three: counted by SequenceGate
  std::int64_t num_missing = 0;
  std::int64_t num_jumps = 0;                ///< single outliers in time or seq
  std::int64_t num_second_source_signs = 0;  ///< indications of a second source
  double clock_change_s = 0.0;               ///< last step of its clock
  std::int64_t first_utime = 0;              ///< of measurement; of receipt for unknown types
  std::int64_t last_utime = 0;
  std::array<std::int64_t, bus::kNumReasons> num_refused_by_reason{};
  std::string first_refusal;  ///< reason and detail of the first refused message
};

bool is_guarded(std::string_view channel) {
  const auto known = bus::find_channel(channel);
  return known && bus::info(*known).role != bus::Role::kService;
}

void count_refusal(const bus::Rejection& rejection, ChannelSurvey& survey) {
  ++survey.num_refused;
  ++survey.num_refused_by_reason[static_cast<std::size_t>(rejection.reason)];
  if (!survey.first_refusal.empty()) return;
  survey.first_refusal = std::string(bus::to_string(rejection.reason)) +
                         (rejection.detail.empty() ? "" : ": " + rejection.detail);
}

void count(const io::LogEvent& event, bus::SequenceGate& gate, ChannelSurvey& survey) {
  const bool first = survey.last_utime == 0;  // first valid message
  ++survey.num_messages;
  survey.num_bytes += static_cast<std::int64_t>(event.data.size());
  std::int64_t utime = event.timestamp_us;
  if (is_guarded(event.channel)) {
    const auto decoded =
        bus::decode(*bus::find_channel(event.channel), event.data.data(), event.data.size());
    if (const auto* rejection = std::get_if<bus::Rejection>(&decoded)) {
      count_refusal(*rejection, survey);
      return;
    }
    const auto& message = std::get<bus::Message>(decoded);
    utime = bus::utime_of(message);
    const auto decision = gate.accept(*bus::find_channel(event.channel), bus::seq_of(message),
                                      utime, event.timestamp_us);
    if (decision == bus::GateDecision::kHeld) return;  // its time may be invalid
  }
  survey.first_utime = first ? utime : std::min(survey.first_utime, utime);
  survey.last_utime = first ? utime : std::max(survey.last_utime, utime);
}

/// Content of a whole log.
struct LogSurvey {
  std::map<std::string, ChannelSurvey> channels;
  std::vector<io::LogGap> gaps;
  std::vector<std::string> notes;  ///< for several logs: gaps and overlaps between them
  std::int64_t num_events = 0;
  std::uint64_t file_size = 0;
  std::int64_t first_timestamp_us = 0;  ///< time of receipt
  std::int64_t last_timestamp_us = 0;

  std::int64_t num_refused() const {
    std::int64_t num = 0;
    for (const auto& [name, channel] : channels) num += channel.num_refused;
    return num;
  }
  bool knows_a_channel() const {
    return std::any_of(channels.begin(), channels.end(), [](const auto& entry) {
      return bus::find_channel(entry.first).has_value();
    });
  }
  bool sound() const { return gaps.empty() && num_refused() == 0 && knows_a_channel(); }
};

/// Which robots' channels the log has; empty: none with a name.
std::string robots_note(const LogSurvey& survey) {
  std::set<std::string_view> robots;
  for (const auto& [name, channel] : survey.channels) robots.insert(bus::split_robot(name).robot);
  robots.erase("");
  if (robots.empty()) return {};
  return fmt::format("channels of the robots {}: `orchard log split` writes a log for each",
                     fmt::join(robots, ", "));
}

/// Reads a whole log, or its parts as one log. Throws io::FileError when it cannot be opened or has
/// no events.
LogSurvey survey_log(const io::LogPaths& logs) {
  const std::string path = logs.text();
  io::LogSeries reader(logs);
  LogSurvey survey;
  bus::SequenceGate gate;
  survey.file_size = reader.file_size();
  io::ProgressBar bar("reading " + path);
  while (const auto event = reader.next()) {
    count(*event, gate, survey.channels[event->channel]);
    if (survey.num_events == 0) survey.first_timestamp_us = event->timestamp_us;
    survey.last_timestamp_us = event->timestamp_us;
    ++survey.num_events;
    bar.update(reader.position(), reader.file_size());
  }
  bar.finish();
  gate.finish();
  for (auto& [name, channel] : survey.channels) {
    if (!is_guarded(name)) continue;
    const bus::SequenceCounts& counts = gate.counts(*bus::find_channel(name));
    channel.num_duplicates = counts.num_duplicate;
    channel.num_missing = counts.num_lost;
    channel.num_jumps = counts.num_jumps;
    channel.num_second_source_signs = counts.num_second_source_signs;
    channel.clock_change_s = counts.clock_change_s;
  }
  survey.gaps = reader.gaps();
  survey.notes = reader.notes();
  if (const std::string note = robots_note(survey); !note.empty()) survey.notes.push_back(note);
  if (survey.num_events == 0) {
    throw io::FileError(
        path + (survey.file_size == 0
                    ? " is empty; give an LCM log (of lcm-logger or `orchard record`)"
                    : " has no LCM event; give an LCM log (of lcm-logger or `orchard record`)"));
  }
  return survey;
}

/// Content and faults of a log as JSON; times in seconds, ends with a newline.
std::string log_json(const std::string& path, const LogSurvey& survey) {
  using nlohmann::ordered_json;
  ordered_json json{
      {"log", path},
      {"sound", survey.sound()},
      {"num_bytes", survey.file_size},
      {"num_messages", survey.num_events},
      {"span_s", timing::seconds(survey.last_timestamp_us - survey.first_timestamp_us)}};
  json["channels"] = ordered_json::array();
  for (const auto& [name, channel] : survey.channels) {
    const auto known = bus::find_channel(name);
    ordered_json entry{
        {"channel", name},
        {"type", known ? ordered_json(std::string(bus::info(*known).type)) : ordered_json()},
        {"num_messages", channel.num_messages},
        {"num_bytes", channel.num_bytes},
        {"num_refused", channel.num_refused},
        {"num_missing", channel.num_missing},
        {"num_duplicates", channel.num_duplicates},
        {"num_leaps", channel.num_jumps},
        {"first_utime", channel.first_utime},
        {"last_utime", channel.last_utime}};
    if (!channel.first_refusal.empty()) entry["first_refusal"] = channel.first_refusal;
    json["channels"].push_back(std::move(entry));
  }
  json["gaps"] = ordered_json::array();
  for (const io::LogGap& gap : survey.gaps) {
    json["gaps"].push_back({{"log", gap.log}, {"offset", gap.offset}, {"num_bytes", gap.size}});
  }
  if (!survey.notes.empty()) json["notes"] = survey.notes;
  // Text in a damaged log may be invalid UTF-8.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

const char* role_name(const std::string& channel) {
  constexpr const char* kNames[] = {"source", "derived", "service"};
  const auto known = bus::find_channel(channel);
  return known ? kNames[static_cast<int>(bus::info(*known).role)] : "unknown";
}

void print_channels(const LogSurvey& survey) {
  std::printf("%-14s %-14s %-8s %10s %9s %12s %10s\n", "channel", "type", "role", "messages", "Hz",
              "bytes", "span (s)");
  for (const auto& [name, channel] : survey.channels) {
    const auto known = bus::find_channel(name);
    const std::string type = known ? std::string(bus::info(*known).type) : "?";
    const double span_s = timing::seconds(channel.last_utime - channel.first_utime);
    const double rate_hz =
        span_s > 0.0 ? static_cast<double>(channel.num_messages - 1) / span_s : 0.0;
    std::printf("%-14s %-14s %-8s %10" PRId64 " %9.2f %12" PRId64 " %10.3f\n", name.c_str(),
                type.c_str(), role_name(name), channel.num_messages, rate_hz, channel.num_bytes,
                span_s);
  }
}

void print_gap(const io::LogGap& gap) {
  std::printf("%s: damaged: %" PRIu64 " bytes lost at offset %" PRIu64 "\n", gap.log.c_str(),
              gap.size, gap.offset);
}

/// Prints one line per finding.
void print_findings(const std::string& path, const LogSurvey& survey) {
  for (const io::LogGap& gap : survey.gaps) print_gap(gap);
  for (const std::string& note : survey.notes) std::printf("%s: %s\n", path.c_str(), note.c_str());
  for (const auto& [name, channel] : survey.channels) {
    const auto print = [&, &name = name](bool is_so, const std::string& words) {
      if (is_so) std::printf("%s: %s: %s\n", path.c_str(), name.c_str(), words.c_str());
    };
    print(channel.num_refused > 0,
          fmt::format("{} of {} messages are invalid (first: {})", channel.num_refused,
                      channel.num_messages, channel.first_refusal));
    print(channel.num_missing > 0,
          fmt::format("{} messages are missing (gaps in seq)", channel.num_missing));
    print(channel.num_duplicates > 0,
          fmt::format("{} messages repeat an older seq (several senders, or a restart)",
                      channel.num_duplicates));
    print(channel.num_jumps > 0,
          fmt::format("{} single messages jump in time or seq", channel.num_jumps));
    print(channel.clock_change_s != 0.0,
          fmt::format("the clock of the sender was changed by {:.1f} s", channel.clock_change_s));
    print(channel.num_second_source_signs > 2,
          "sent by two sources, or by one that restarts again and again");
  }
  if (!survey.knows_a_channel()) {
    std::printf("%s: has no channel of Orchard Mapper\n", path.c_str());
  }
}

}  // namespace

int run_log_info(const LogOptions& options) {
  const io::LogPaths logs(options.log_paths);
  const LogSurvey survey = survey_log(logs);
  if (options.json) {
    std::fputs(log_json(logs.text(), survey).c_str(), stdout);
    return bus::kExitOk;
  }
  std::printf("%s: %" PRIu64 " bytes, %" PRId64 " messages, received over %.3f s\n",
              logs.text().c_str(), survey.file_size, survey.num_events,
              timing::seconds(survey.last_timestamp_us - survey.first_timestamp_us));
  print_channels(survey);
  for (const std::string& note : survey.notes) std::printf("%s\n", note.c_str());
  if (!survey.gaps.empty() || survey.num_refused() > 0) {
    std::printf("parts of the log cannot be read; see `orchard log check %s`\n",
                logs.paths().size() == 1 ? logs.text().c_str() : "LOG");
  }
  return bus::kExitOk;
}

int run_log_check(const LogOptions& options) {
  const io::LogPaths logs(options.log_paths);
  const std::string path = logs.text();
  const LogSurvey survey = survey_log(logs);
  if (options.json) {
    std::fputs(log_json(path, survey).c_str(), stdout);
    return survey.sound() ? bus::kExitOk : bus::kExitInput;
  }
  print_findings(path, survey);
  if (survey.sound()) {
    std::printf("%s: sound: %" PRId64 " messages\n", path.c_str(), survey.num_events);
    return bus::kExitOk;
  }
  if (survey.knows_a_channel()) {
    std::printf("%s: %" PRId64 " messages are valid; `orchard map` uses them\n", path.c_str(),
                survey.num_events - survey.num_refused());
  }
  return bus::kExitInput;
}

int run_log_config(const LogOptions& options) {
  const bus::LoggedRig rig = bus::rig_of_log(options.log_path, options.process);
  std::printf("# %s: configuration of", options.log_path.c_str());
  for (const std::string& process : rig.processes) std::printf(" %s", process.c_str());
  std::printf(", version %s\n%s", rig.version.c_str(), rig.yaml.c_str());
  return bus::kExitOk;
}

int run_log_repair(const LogOptions& options) {
  make_parent_folder(options.out_path);
  InterruptibleWork work("copying");
  const io::LogRepair read = io::repair_log(
      options.log_path, options.out_path,
      [&work](std::uint64_t done, std::uint64_t total) { work.update(done, total); });
  work.finish();
  for (const io::LogGap& gap : read.gaps) print_gap(gap);
  std::printf("%s: recovered %" PRId64 " messages, lost %" PRIu64 " bytes in %zu places\n",
              options.out_path.c_str(), read.num_events, read.num_lost_bytes, read.gaps.size());
  return bus::kExitOk;
}

namespace {

/// The logs of the robots of one log, each made when its first message comes.
class RobotLogs {
 public:
  explicit RobotLogs(std::string folder) : folder_(std::move(folder)) {}

  void write(const io::LogEvent& event) {
    const bus::RobotChannel channel = bus::split_robot(event.channel);
    Part& part = parts_[std::string(channel.robot)];
    if (!part.log) part.log = std::make_unique<io::LogWriter>(path_of(channel.robot));
    part.log->write(event.timestamp_us, channel.name, event.data);
    ++part.num_messages;
  }

  bool has_robots() const { return !parts_.empty() && !parts_.rbegin()->first.empty(); }

  void close() {
    for (auto& [robot, part] : parts_) {
      part.log->close();
      std::printf("%s: %" PRId64 " messages\n", path_of(robot).c_str(), part.num_messages);
    }
  }

 private:
  struct Part {
    std::unique_ptr<io::LogWriter> log;
    std::int64_t num_messages = 0;
  };

  std::string path_of(std::string_view robot) const {
    return folder_ + "/" + (robot.empty() ? "unnamed" : std::string(robot)) + ".lcm";
  }

  std::string folder_;
  std::map<std::string, Part> parts_;
};

}  // namespace

int run_log_split(const LogOptions& options) {
  io::LogSeries reader{io::LogPaths(options.log_paths)};
  io::make_folder(options.out_path);
  InterruptibleWork work("splitting");
  RobotLogs logs(options.out_path);
  while (const auto event = reader.next()) {
    logs.write(*event);
    work.update(reader.position(), reader.file_size());
  }
  work.finish();
  if (!logs.has_robots()) {
    throw io::FileError(
        io::LogPaths(options.log_paths).text() +
        ": has no channel with a robot's name, such as koala/SCAN; use it as it is");
  }
  for (const io::LogGap& gap : reader.gaps()) print_gap(gap);
  for (const std::string& note : reader.notes()) std::printf("%s\n", note.c_str());
  logs.close();
  return bus::kExitOk;
}

}  // namespace orchard::cli
