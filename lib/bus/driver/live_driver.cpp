// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/live_driver.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>

#include "io/progress_bar.hpp"

namespace orchard::bus {
namespace {

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

LiveDriver::LiveDriver(Bus& bus, Source& source, const std::string& name,
                       const ProcessOptions& options)
    : bus_(bus),
      source_(source),
      options_(options),
      report_(bus, name, options.config),
      missing_(options.wait_for) {
  if (missing_.empty()) return;
  bus_.subscribe_status([this](const Status& heard) {
    missing_.erase(std::remove(missing_.begin(), missing_.end(), heard.name), missing_.end());
  });
}

void LiveDriver::run(StopSignal& stop) {
  if (!wait_for_others(stop)) return;
  const std::optional<double> duration_s = source_.duration_s();
  if (duration_s) {
    spdlog::info("publishes {:.0f} s of messages at speed {:g}: done in {}", *duration_s,
                 options_.speed, io::waiting_text(*duration_s / options_.speed));
  }
  io::ProgressBar bar("publishing", duration_s.has_value());
  std::optional<Message> message = source_.next();
  const Clock::time_point start = Clock::now();
  const std::int64_t first_utime = message ? utime_of(*message) : 0;
  while (message) {
    const double due_us = static_cast<double>(utime_of(*message) - first_utime) / options_.speed;
    const auto due = start + std::chrono::microseconds(static_cast<std::int64_t>(due_us));
    if (!wait_until(due, stop)) break;
    bus_.publish(*message);
    ++num_published_;
    bar.update(static_cast<std::uint64_t>(utime_of(*message) - first_utime),
               static_cast<std::uint64_t>(1e6 * duration_s.value_or(0.0)));
    message = source_.next();
  }
  bar.finish();
  ended_ = !message;
  if (ended_) spdlog::info("the source has ended after {} messages", num_published_);
  while (ended_ && options_.hold && !stop.raised()) {
    wait_until(Clock::now() + std::chrono::seconds(1), stop);
  }
  report_.send(status());
}

bool LiveDriver::wait_for_others(StopSignal& stop) {
  if (!missing_.empty()) spdlog::info("waits for {}", join(missing_));
  Clock::time_point next_word = Clock::now() + std::chrono::seconds(5);
  while (!missing_.empty()) {
    if (!wait_until(Clock::now() + std::chrono::milliseconds(20), stop)) return false;
    if (Clock::now() >= next_word && !missing_.empty()) {
      spdlog::warn("still waits for {}: started, on the same LCM URL, and not in --lockstep?",
                   join(missing_));
      next_word += std::chrono::seconds(5);
    }
  }
  return true;
}

bool LiveDriver::wait_until(Clock::time_point until, StopSignal& stop) {
  while (!stop.raised()) {
    if (report_.due()) report_.send(status());
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - Clock::now());
    if (left.count() <= 0) return true;
    const int timeout_ms =
        static_cast<int>(std::min<std::int64_t>(left.count(), report_.ms_until_due()));
    if (stop.wait(bus_.fileno(), timeout_ms)) bus_.handle(0);
  }
  return false;
}

Status LiveDriver::status() const {
  Status status;
  status.num_published = num_published_;
  status.num_bad = bus_.counts().num_bad();
  status.num_lost = bus_.counts().num_unsent;
  if (!missing_.empty()) {
    status.level = Level::kWaiting;
    status.text = "waits for " + join(missing_);
  } else if (ended_) {
    status.text = "the source has ended";
  }
  if (bus_.counts().num_unsent > 0) status.level = Level::kWarning;
  return status;
}

}  // namespace orchard::bus
