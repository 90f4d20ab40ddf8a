// SPDX-License-Identifier: BSD-3-Clause
#include "io/log/log_series.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <tuple>

#include "io/file_error.hpp"

namespace orchard::io {
namespace {

/// The bits of an offset above these contain the number of its log; files up to 256 TB.
constexpr int kOffsetBits = 48;
constexpr std::size_t kLogsMax = 4096;

/// Max time difference between copies of one event in overlapping logs.
constexpr std::int64_t kRepeatWithin_us = 60'000'000;

/// Minimum gap between two logs that is reported.
constexpr std::int64_t kBreak_us = 1'000'000;

constexpr std::size_t kReadersOpen = 8;

/// FNV-1a of channel and data.
std::uint64_t fingerprint(const LogEvent& event) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  const auto add = [&hash](std::uint8_t byte) { hash = (hash ^ byte) * 0x100000001b3ull; };
  for (const char c : event.channel) add(static_cast<std::uint8_t>(c));
  add(0);
  for (const std::uint8_t byte : event.data) add(byte);
  return hash;
}

std::string name_of(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace

std::string LogPaths::text() const {
  if (paths_.size() == 1) return paths_.front();
  return paths_.front() + " and " + std::to_string(paths_.size() - 1) + " more";
}

std::string LogPaths::names() const {
  std::string names;
  for (const std::string& path : paths_) names += (names.empty() ? "" : ", ") + name_of(path);
  return names;
}

LogSeries::LogSeries(const LogPaths& paths) {
  if (paths.paths().empty() || paths.paths().size() > kLogsMax) {
    throw FileError("give 1 to " + std::to_string(kLogsMax) + " logs");
  }
  for (const std::string& path : paths.paths()) {
    Log log;
    log.path = path;
    LogReader reader(path);
    file_size_ += reader.file_size();
    if (paths.paths().size() > 1) {
      if (const auto first = reader.next()) log.first_timestamp_us = first->timestamp_us;
    }
    logs_.push_back(std::move(log));
  }
  std::sort(logs_.begin(), logs_.end(), [](const Log& a, const Log& b) {
    return std::tie(a.first_timestamp_us, a.path) < std::tie(b.first_timestamp_us, b.path);
  });
}

void LogSeries::advance(Log& log) {
  const std::uint64_t before = log.reader->position();
  log.head = log.reader->next();
  position_ += log.reader->position() - before;
  log.gaps = log.reader->gaps();
  if (!log.head) log.reader.reset();
}

/// Log with the earliest next event; null at the end. Logs are opened when their time comes.
LogSeries::Log* LogSeries::earliest() {
  const auto first_head = [this] {
    Log* first = nullptr;
    for (Log& log : logs_) {
      if (log.head && (first == nullptr || log.head->timestamp_us < first->head->timestamp_us)) {
        first = &log;
      }
    }
    return first;
  };
  Log* first = first_head();
  while (num_begun_ < logs_.size() &&
         (first == nullptr ||
          logs_[num_begun_].first_timestamp_us.value_or(INT64_MIN) <= first->head->timestamp_us)) {
    Log& log = logs_[num_begun_++];
    log.reader = std::make_unique<LogReader>(log.path);
    advance(log);
    if (first == nullptr && log.head && last_timestamp_us_ &&
        log.head->timestamp_us - *last_timestamp_us_ > kBreak_us) {
      char text[64];
      std::snprintf(text, sizeof(text), "%.1f",
                    1e-6 * static_cast<double>(log.head->timestamp_us - *last_timestamp_us_));
      breaks_.push_back("nothing was recorded for " + std::string(text) + " s before " +
                        name_of(log.path));
    }
    first = first_head();
  }
  return first;
}

bool LogSeries::is_in_another(const Log& log, const LogEvent& event) {
  while (!recent_.empty() && event.timestamp_us - recent_.front().first > kRepeatWithin_us) {
    log_of_.erase(recent_.front().second);
    recent_.pop_front();
  }
  const std::uint64_t hash = fingerprint(event);
  const auto [known, is_new] = log_of_.emplace(hash, &log);
  if (is_new) recent_.emplace_back(event.timestamp_us, hash);
  return known->second != &log;
}

std::optional<LogEvent> LogSeries::next() {
  while (Log* log = earliest()) {
    LogEvent event = *std::move(log->head);
    advance(*log);
    // Repetitions within one log are from the sender; they are handled when decoding.
    if (logs_.size() > 1 && is_in_another(*log, event)) {
      ++log->num_repeated;
      continue;
    }
    ++num_events_;
    last_timestamp_us_ = std::max(last_timestamp_us_.value_or(INT64_MIN), event.timestamp_us);
    event.offset |= static_cast<std::uint64_t>(log - logs_.data()) << kOffsetBits;
    return event;
  }
  return std::nullopt;
}

LogEvent LogSeries::read_at(std::uint64_t offset) {
  Log& log = logs_.at(static_cast<std::size_t>(offset >> kOffsetBits));
  if (!log.reader) {
    const auto is_open = [](const Log& other) { return other.reader != nullptr; };
    if (std::count_if(logs_.begin(), logs_.end(), is_open) >= std::ptrdiff_t{kReadersOpen}) {
      for (Log& other : logs_) other.reader.reset();
    }
    log.reader = std::make_unique<LogReader>(log.path);
  }
  return log.reader->read_at(offset & ((std::uint64_t{1} << kOffsetBits) - 1));
}

std::string LogSeries::where(std::uint64_t offset) const {
  return logs_.at(static_cast<std::size_t>(offset >> kOffsetBits)).path + " at offset " +
         std::to_string(offset & ((std::uint64_t{1} << kOffsetBits) - 1));
}

std::vector<LogGap> LogSeries::gaps() const {
  std::vector<LogGap> gaps;
  for (const Log& log : logs_) gaps.insert(gaps.end(), log.gaps.begin(), log.gaps.end());
  return gaps;
}

std::vector<std::string> LogSeries::notes() const {
  std::vector<std::string> notes = breaks_;
  if (logs_.size() == 1) return notes;
  for (const Log& log : logs_) {
    if (!log.first_timestamp_us) notes.push_back(log.path + " has no LCM event");
    if (log.num_repeated > 0) {
      notes.push_back(std::to_string(log.num_repeated) + " messages of " + name_of(log.path) +
                      " are also in another log; they are used once");
    }
  }
  return notes;
}

}  // namespace orchard::io
