// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/status_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "text/encoded_text.hpp"

namespace orchard::cli {
namespace {

constexpr const char* kRed = "\033[31m";
constexpr const char* kYellow = "\033[33m";
constexpr const char* kGreen = "\033[32m";
constexpr const char* kPlain = "\033[0m";

std::string cut(std::string line, std::size_t width) {
  if (width > 0 && line.size() > width) line.resize(width);
  return line;
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), seconds < 9.95 ? "%.1f s" : "%.0f s", seconds);
  return text;
}

const char* colour_of(const std::string& word) {
  if (word == "ok") return kGreen;
  return word == "waiting" || word == "warning" ? kYellow : kRed;
}

/// The process's own text with remarks on its counts and its clock.
std::string remarks(const ProcessView& process) {
  std::string text = printable_text(process.status.text);
  const auto add = [&text](const std::string& words) {
    text += (text.empty() ? "" : "; ") + words;
  };
  if (process.age_s > kSilent_s) add("no STATUS for " + seconds_text(process.age_s));
  if (std::abs(process.clock_offset_s) > kClockOffsetMax_s) {
    char words[96];
    std::snprintf(words, sizeof(words),
                  "its clock is %.3f s %s this machine's: synchronise the clocks (chrony)",
                  std::abs(process.clock_offset_s),
                  process.clock_offset_s > 0 ? "ahead of" : "behind");
    add(words);
  }
  return text;
}

}  // namespace

std::string state_word(const ProcessView& process) {
  if (process.age_s > kSilent_s) return "silent";
  switch (process.status.level) {
    case bus::Level::kOk:
      return "ok";
    case bus::Level::kWaiting:
      return "waiting";
    case bus::Level::kWarning:
      return "warning";
    default:
      return "error";
  }
}

bool needs_attention(const ProcessView& process) {
  const std::string word = state_word(process);
  return (word != "ok" && word != "waiting") ||
         std::abs(process.clock_offset_s) > kClockOffsetMax_s;
}

std::string status_table(const std::vector<ProcessView>& processes, std::size_t width,
                         bool colour) {
  char line[512];
  std::snprintf(line, sizeof(line), "%-24s %-12s %-8s %8s %10s %9s %7s %7s", "process", "host",
                "state", "in Hz", "latency ms", "out", "lost", "refused");
  std::string text = cut(line, width) + "\n";
  for (const ProcessView& process : processes) text += process_lines(process, width, colour);
  if (processes.empty())
    text += "no process has reported its status yet; start one with `orchard live`\n";
  return text;
}

std::string process_lines(const ProcessView& process, std::size_t width, bool colour) {
  const bus::Status& s = process.status;
  const std::string word = state_word(process);
  char line[512];
  std::snprintf(line, sizeof(line), "%-24.24s %-12.12s ", printable_text(s.name).c_str(),
                printable_text(s.host).c_str());
  std::string row = line;
  char state[16];
  std::snprintf(state, sizeof(state), "%-8s", word.c_str());
  std::snprintf(line, sizeof(line), " %8.1f %10.2f %9lld %7lld %7lld", process.input_hz,
                1e3 * s.latency_max_s, static_cast<long long>(s.num_published),
                static_cast<long long>(s.num_lost), static_cast<long long>(s.num_bad));
  const std::string rest = cut(line, width > row.size() + 8 ? width - row.size() - 8 : width);
  std::string text =
      row + (colour ? colour_of(word) + std::string(state) + kPlain : state) + rest + "\n";
  if (const std::string words = remarks(process); !words.empty()) {
    text += cut("    " + words, width) + "\n";
  }
  return text;
}

std::string status_json(const std::vector<ProcessView>& processes) {
  nlohmann::ordered_json json;
  json["processes"] = nlohmann::ordered_json::array();
  for (const ProcessView& process : processes) {
    const bus::Status& s = process.status;
    json["processes"].push_back({{"name", s.name},
                                 {"host", s.host},
                                 {"state", state_word(process)},
                                 {"text", s.text},
                                 {"age_s", process.age_s},
                                 {"input_hz", process.input_hz},
                                 {"latency_mean_s", s.latency_mean_s},
                                 {"latency_max_s", s.latency_max_s},
                                 {"num_good", s.num_good},
                                 {"num_bad", s.num_bad},
                                 {"num_lost", s.num_lost},
                                 {"num_late", s.num_late},
                                 {"num_duplicate", s.num_duplicate},
                                 {"num_published", s.num_published},
                                 {"clock_offset_s", process.clock_offset_s}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace orchard::cli
