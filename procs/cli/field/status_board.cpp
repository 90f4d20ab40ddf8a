// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/status_board.hpp"

#include <fmt/core.h>
#include <sys/ioctl.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <nlohmann/json.hpp>

#include "bus/node/process_report.hpp"
#include "text/encoded_text.hpp"

namespace orchard::cli {
namespace {

/// Number of STATUS messages for the estimate of a clock offset: the one with the least delay is
/// used.
constexpr std::size_t kNumOffsets = 8;

/// Silence after which a process counts as ended; STATUS is sent once a second.
constexpr std::int64_t kSilentAfter_us = 1'200'000;

/// Silence after which a process is no longer shown.
constexpr std::int64_t kForgetAfter_us = 60'000'000;

}  // namespace

void StatusBoard::note(const bus::Status& status, std::int64_t receipt_utime) {
  forget_earlier(status, receipt_utime);
  const auto key = std::make_pair(status.host, status.name);
  const auto known = entries_.find(key);
  Entry& entry = entries_[key];
  const bool goes_on = known != entries_.end() && status.seq > entry.last.seq;
  entry.num_new_lost = goes_on ? status.num_lost - entry.last.num_lost : 0;
  entry.last = status;
  entry.receipt_utime = receipt_utime;
  entry.offsets_us.push_back(status.utime - receipt_utime);
  if (entry.offsets_us.size() > kNumOffsets) entry.offsets_us.erase(entry.offsets_us.begin());
}

/// Removes the earlier entry of a restarted process, whose host field has another process id.
void StatusBoard::forget_earlier(const bus::Status& status, std::int64_t receipt_utime) {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    const bool same = entry->first.second == status.name &&
                      bus::machine_of(entry->first.first) == bus::machine_of(status.host) &&
                      entry->first.first != status.host;
    const bool silent = receipt_utime - entry->second.receipt_utime > kSilentAfter_us;
    entry = same && silent ? entries_.erase(entry) : std::next(entry);
  }
}

std::vector<ProcessView> StatusBoard::processes(std::int64_t now_utime) const {
  std::vector<ProcessView> views;
  for (const auto& [key, entry] : entries_) {
    const std::int64_t age_us = now_utime - entry.receipt_utime;
    if (age_us > kForgetAfter_us) continue;
    ProcessView view;
    view.status = entry.last;
    view.age_s = 1e-6 * static_cast<double>(age_us);
    if (entry.last.input_period_s > 0.0) view.input_hz = 1.0 / entry.last.input_period_s;
    // Transport delays the receipt, never advances it: the max difference has the least delay.
    if (bus::machine_of(key.first) != own_machine_) {
      view.clock_offset_s = 1e-6 * static_cast<double>(*std::max_element(entry.offsets_us.begin(),
                                                                         entry.offsets_us.end()));
    }
    view.num_new_lost = entry.num_new_lost;
    views.push_back(std::move(view));
  }
  return views;
}

namespace {

constexpr const char* kRed = "\033[31m";
constexpr const char* kYellow = "\033[33m";
constexpr const char* kGreen = "\033[32m";
constexpr const char* kPlain = "\033[0m";

std::string cut(std::string line, std::size_t width) {
  if (width > 0 && line.size() > width) line.resize(width);
  return line;
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
  if (process.age_s > kSilent_s) {
    add(fmt::format("no STATUS for {:.{}f} s", process.age_s, process.age_s < 9.95 ? 1 : 0));
  }
  if (std::abs(process.clock_offset_s) > kClockOffsetMax_s) {
    add(fmt::format("its clock is {:.3f} s {} this machine's: synchronise the clocks (chrony)",
                    std::abs(process.clock_offset_s),
                    process.clock_offset_s > 0 ? "ahead of" : "behind"));
  }
  return text;
}

}  // namespace

std::string state_word(const ProcessView& process) {
  constexpr const char* kWords[] = {"ok", "waiting", "warning", "error"};
  if (process.age_s > kSilent_s) return "silent";
  return kWords[std::clamp(static_cast<int>(process.status.level), 0, 3)];
}

bool needs_attention(const ProcessView& process) {
  const std::string word = state_word(process);
  return (word != "ok" && word != "waiting") ||
         std::abs(process.clock_offset_s) > kClockOffsetMax_s;
}

std::string status_table(const std::vector<ProcessView>& processes, std::size_t width,
                         bool colour) {
  std::string text =
      cut(fmt::format("{:<24} {:<12} {:<8} {:>8} {:>10} {:>9} {:>7} {:>7}", "process", "host",
                      "state", "in Hz", "latency ms", "out", "lost", "refused"),
          width) +
      "\n";
  for (const ProcessView& process : processes) text += process_lines(process, width, colour);
  if (processes.empty())
    text += "no process has reported its status yet; start one with `orchard live`\n";
  return text;
}

std::string process_lines(const ProcessView& process, std::size_t width, bool colour) {
  const bus::Status& s = process.status;
  const std::string word = state_word(process);
  const std::string row =
      fmt::format("{:<24.24} {:<12.12} ", printable_text(s.name), printable_text(s.host));
  const std::string state = fmt::format("{:<8}", word);
  const std::string rest =
      cut(fmt::format(" {:8.1f} {:10.2f} {:9} {:7} {:7}", process.input_hz, 1e3 * s.latency_max_s,
                      s.num_published, s.num_lost, s.num_bad),
          width > row.size() + 8 ? width - row.size() - 8 : width);
  std::string text = row + (colour ? colour_of(word) + state + kPlain : state) + rest + "\n";
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

namespace {

std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 100;
}

}  // namespace

bool StatusScreen::is_terminal() { return isatty(STDOUT_FILENO) != 0; }

void StatusScreen::show(const StatusBoard& board, const std::string& headline,
                        std::int64_t now_utime) {
  const std::vector<ProcessView> processes = board.processes(now_utime);
  if (!is_terminal()) return print_changes(processes);
  // Move home, overwrite, clear the rest: this flickers less than clearing the whole screen.
  std::string text = headline + "\n" + status_table(processes, terminal_width(), true);
  std::string drawn = "\033[H";
  for (const char c : text) drawn += c == '\n' ? std::string("\033[K\n") : std::string(1, c);
  std::printf("%s\033[J", drawn.c_str());
  std::fflush(stdout);
}

void StatusScreen::print_changes(const std::vector<ProcessView>& processes) {
  for (const ProcessView& process : processes) {
    // Numbers in the text change every second: compare the text without digits.
    std::string key = state_word(process);
    for (const char c : process.status.text) {
      if (c < '0' || c > '9') key += c;
    }
    std::string& said = said_[process.status.host + "/" + process.status.name];
    if (said == key) continue;
    said = key;
    std::printf("%s", process_lines(process, 0, false).c_str());
  }
  std::fflush(stdout);
}

}  // namespace orchard::cli
