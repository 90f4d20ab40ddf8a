// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/log_commands.hpp"

#include <cinttypes>
#include <cstdio>

#include "bus/process/process.hpp"
#include "bus/replay/logged_rig.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/logs/log_json.hpp"
#include "cli/logs/log_survey.hpp"
#include "cli/parent_folder.hpp"
#include "io/log/log_writer.hpp"
#include "timing/units.hpp"

namespace orchard::cli {
namespace {

const char* role_name(const std::string& channel) {
  const auto known = bus::find_channel(channel);
  if (!known) return "unknown";
  switch (bus::info(*known).role) {
    case bus::Role::kSource:
      return "source";
    case bus::Role::kDerived:
      return "derived";
    case bus::Role::kService:
      break;
  }
  return "service";
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

void print_gap(const std::string& path, const io::LogGap& gap) {
  std::printf("%s: damaged: %" PRIu64 " bytes lost at offset %" PRIu64 "\n", path.c_str(), gap.size,
              gap.offset);
}

/// Prints one line per finding.
void print_findings(const std::string& path, const LogSurvey& survey) {
  for (const io::LogGap& gap : survey.gaps) {
    print_gap(path, gap);
  }
  for (const auto& [name, channel] : survey.channels) {
    if (channel.num_refused > 0) {
      std::printf("%s: %s: %" PRId64 " of %" PRId64 " messages are invalid (first: %s)\n",
                  path.c_str(), name.c_str(), channel.num_refused, channel.num_messages,
                  channel.first_refusal.c_str());
    }
    if (channel.num_missing > 0) {
      std::printf("%s: %s: %" PRId64 " messages are missing (gaps in seq)\n", path.c_str(),
                  name.c_str(), channel.num_missing);
    }
    if (channel.num_duplicates > 0) {
      std::printf("%s: %s: %" PRId64
                  " messages repeat an older seq (several senders, or a restart)\n",
                  path.c_str(), name.c_str(), channel.num_duplicates);
    }
    if (channel.num_jumps > 0) {
      std::printf("%s: %s: %" PRId64 " single messages jump in time or seq\n", path.c_str(),
                  name.c_str(), channel.num_jumps);
    }
    if (channel.clock_change_s != 0.0) {
      std::printf("%s: %s: the clock of the sender was changed by %.1f s\n", path.c_str(),
                  name.c_str(), channel.clock_change_s);
    }
    if (channel.num_second_source_signs > 2) {
      std::printf("%s: %s: sent by two sources, or by one that restarts again and again\n",
                  path.c_str(), name.c_str());
    }
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
  const LogSurvey survey = survey_log(options.log_path);
  if (options.json) {
    std::fputs(log_json(options.log_path, survey).c_str(), stdout);
    return survey.sound() ? bus::kExitOk : bus::kExitInput;
  }
  print_findings(options.log_path, survey);
  if (survey.sound()) {
    std::printf("%s: sound: %" PRId64 " messages\n", options.log_path.c_str(), survey.num_events);
    return bus::kExitOk;
  }
  if (survey.knows_a_channel()) {
    std::printf("%s: %" PRId64 " messages are valid; `orchard map` uses them\n",
                options.log_path.c_str(), survey.num_events - survey.num_refused());
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
  for (const io::LogGap& gap : read.gaps) print_gap(options.log_path, gap);
  std::printf("%s: recovered %" PRId64 " messages, lost %" PRIu64 " bytes in %zu places\n",
              options.out_path.c_str(), read.num_events, read.num_lost_bytes, read.gaps.size());
  return bus::kExitOk;
}

}  // namespace orchard::cli
