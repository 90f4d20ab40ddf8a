// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/log_survey.hpp"

#include <algorithm>
#include <variant>

#include "bus/node/sequence_gate.hpp"
#include "io/file_error.hpp"
#include "io/progress_bar.hpp"

namespace orchard::cli {
namespace {

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

}  // namespace

std::int64_t LogSurvey::num_refused() const {
  std::int64_t num = 0;
  for (const auto& [name, channel] : channels) num += channel.num_refused;
  return num;
}

bool LogSurvey::knows_a_channel() const {
  return std::any_of(channels.begin(), channels.end(),
                     [](const auto& entry) { return bus::find_channel(entry.first).has_value(); });
}

bool LogSurvey::sound() const { return gaps.empty() && num_refused() == 0 && knows_a_channel(); }

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
  if (survey.num_events == 0) {
    throw io::FileError(
        path + (survey.file_size == 0
                    ? " is empty; give an LCM log (of lcm-logger or `orchard record`)"
                    : " has no LCM event; give an LCM log (of lcm-logger or `orchard record`)"));
  }
  return survey;
}

}  // namespace orchard::cli
