// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/log_json.hpp"

#include <nlohmann/json.hpp>

#include "timing/units.hpp"

namespace orchard::cli {

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
    json["gaps"].push_back({{"offset", gap.offset}, {"num_bytes", gap.size}});
  }
  if (!survey.notes.empty()) json["notes"] = survey.notes;
  // Text in a damaged log may be invalid UTF-8.
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace orchard::cli
