// SPDX-License-Identifier: BSD-3-Clause
#include "bus/driver/live_driver.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace orchard::bus {
namespace {

std::string join(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Max duration of a poll: STATUS is due once a second.
constexpr std::chrono::seconds kWaitMax{1};

/// Min time between two texts of one level in the log.
constexpr std::chrono::seconds kSayAgain{10};

timespec to_timespec(std::chrono::nanoseconds time) {
  const auto ns = std::max<std::int64_t>(0, time.count());
  return {static_cast<time_t>(ns / 1000000000), static_cast<long>(ns % 1000000000)};
}

}  // namespace

LiveDriver::LiveDriver(Bus& bus, Driver& driver, const std::string& name,
                       const ProcessOptions& options)
    : bus_(bus),
      driver_(driver),
      options_(options),
      report_(bus, name, options.config),
      peers_(name, report_.host(), options.config.hash),
      missing_(options.wait_for) {
  bus_.subscribe_status([this](const Status& heard) {
    missing_.erase(std::remove(missing_.begin(), missing_.end(), heard.name), missing_.end());
    // A new process learns of this one at once instead of within a second.
    if (peers_.note(heard, wall_utime(), Clock::now())) report_.send_soon(true);
  });
  bus_.subscribe_config([this](const ConfigNotice& notice) { peers_.note(notice, Clock::now()); });
}

void LiveDriver::run(StopSignal& stop) {
  if (!wait_for_others(stop)) return;
  announce_duration();
  const Outbox outbox = [this](const Message& message) { send(message); };
  while (!stop.raised() && !driver_.ended()) {
    wait(driver_.files(), driver_.deadline(), stop);
    if (stop.raised()) break;
    driver_.step(outbox);
    say_condition();
  }
  if (bar_) bar_->finish();
  if (driver_.ended()) spdlog::info("the source has ended after {} messages", num_published_);
  while (driver_.ended() && options_.hold && !stop.raised()) {
    wait({}, Clock::now() + kWaitMax, stop);
  }
  report_.send(status());
}

void LiveDriver::announce_duration() {
  duration_s_ = driver_.duration_s();
  if (!duration_s_) return;
  spdlog::info("publishing {:.0f} s of messages at speed {:g}, which takes {}", *duration_s_,
               options_.speed, io::waiting_text(*duration_s_ / options_.speed));
  bar_.emplace("publishing", true);
}

bool LiveDriver::wait_for_others(StopSignal& stop) {
  if (!missing_.empty()) spdlog::info("waits for {}", join(missing_));
  Clock::time_point next_word = Clock::now() + std::chrono::seconds(5);
  while (!missing_.empty()) {
    wait({}, next_word, stop);
    if (stop.raised()) return false;
    if (Clock::now() >= next_word && !missing_.empty()) {
      spdlog::warn(
          "still waits for {}: check that it is running, on the same LCM URL, and without "
          "--lockstep",
          join(missing_));
      next_word += std::chrono::seconds(5);
    }
  }
  return true;
}

void LiveDriver::wait(std::vector<pollfd> files, Clock::time_point until, const StopSignal& stop) {
  if (report_.due()) {
    if (const double step_s = peers_.check_clock(wall_utime(), Clock::now()); step_s != 0.0) {
      spdlog::warn("the clock of this machine was changed by {:+.1f} s", step_s);
    }
    report_.send(status());
  }
  const std::size_t lcm = files.size();
  files.push_back({bus_.fileno(), POLLIN, 0});
  files.push_back({stop.fileno(), POLLIN, 0});
  const Clock::time_point now = Clock::now();
  const Clock::time_point end =
      std::min(until, now + std::chrono::milliseconds(report_.ms_until_due()));
  const timespec timeout = to_timespec(std::min<Clock::duration>(end - now, kWaitMax));
  if (ppoll(files.data(), files.size(), &timeout, nullptr) <= 0) return;
  if ((files[lcm].revents & POLLIN) != 0) bus_.handle(0);
}

void LiveDriver::send(const Message& message) {
  bus_.publish(message);
  ++num_published_;
  if (!first_utime_) first_utime_ = utime_of(message);
  if (bar_) {
    bar_->update(
        static_cast<std::uint64_t>(std::max<std::int64_t>(0, utime_of(message) - *first_utime_)),
        static_cast<std::uint64_t>(1e6 * duration_s_.value_or(0.0)));
  }
}

void LiveDriver::say_condition() {
  // Logged only when it changes, and counts within it not each time; STATUS repeats it every
  // second.
  DriverCondition condition = driver_.condition();
  const Clock::time_point now = Clock::now();
  if (condition.text == said_.text) return;
  if (condition.level == said_.level && now - said_time_ < kSayAgain) return;
  if (condition.level != Level::kOk) {
    spdlog::warn("{}", condition.text);
  } else {
    spdlog::info("{}", condition.text.empty() ? "no problem any more" : condition.text);
  }
  said_ = std::move(condition);
  said_time_ = now;
}

Status LiveDriver::status() const {
  const DriverCondition condition = driver_.condition();
  Status status;
  status.level = condition.level;
  status.text = condition.text;
  status.num_published = num_published_;
  status.num_bad = bus_.counts().num_bad() + condition.num_bad;
  status.num_lost = bus_.counts().num_unsent;
  if (!missing_.empty()) {
    status.level = Level::kWaiting;
    status.text = "waits for " + join(missing_);
  } else if (driver_.ended()) {
    status.text = "the source has ended";
  }
  const auto add = [&status](Level level, const std::string& text) {
    if (text.empty()) return;
    status.level = std::max(status.level, level);
    status.text = text + (status.text.empty() ? "" : "; " + status.text);
  };
  const Clock::time_point now = Clock::now();
  add(Level::kWarning, peers_.text(now));
  if (const std::string duplicate = peers_.duplicate(now); !duplicate.empty()) {
    add(Level::kError,
        duplicate + " runs beside this one (" + report_.host() + "): stop one of them");
  }
  if (bus_.counts().num_unsent > 0) status.level = std::max(status.level, Level::kWarning);
  return status;
}

}  // namespace orchard::bus
