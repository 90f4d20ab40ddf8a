// SPDX-License-Identifier: BSD-3-Clause
#include "bus/node/peer_processes.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "bus/node/process_report.hpp"
#include "text/number_text.hpp"

namespace orchard::bus {
namespace {

/// STATUS is sent once a second: after three missed ones a process is considered gone.
constexpr std::chrono::milliseconds kGoneAfter{3500};

/// CONFIG comes every ten seconds.
constexpr std::chrono::seconds kConfigGoneAfter{25};

/// How long a step of this machine's clock is reported.
constexpr std::chrono::seconds kClockStepSaid{60};

/// Names come from the network, so the number of processes remembered is limited.
constexpr std::size_t kProcessesMax = 64;

/// Number of STATUS messages compared to estimate a clock offset.
constexpr std::size_t kOffsets = 4;
constexpr std::int64_t kSkew_us = 100'000;
constexpr std::int64_t kClockStep_us = 500'000;

void append(std::string& text, const std::string& more) {
  if (!more.empty()) text += (text.empty() ? "" : "; ") + more;
}

}  // namespace

PeerProcesses::PeerProcesses(std::string name, std::string host, std::int64_t config_hash)
    : name_(std::move(name)), host_(std::move(host)), config_hash_(config_hash) {}

bool PeerProcesses::note(const Status& status, std::int64_t wall_utime, Clock::time_point now) {
  if (status.name == name_ && status.host == host_) return false;
  auto known = std::find_if(processes_.begin(), processes_.end(), [&](const Process& process) {
    return process.name == status.name && process.host == status.host;
  });
  const bool is_new = known == processes_.end() || now - known->heard > kGoneAfter;
  if (known == processes_.end()) {
    if (processes_.size() >= kProcessesMax) {
      processes_.erase(
          std::min_element(processes_.begin(), processes_.end(),
                           [](const Process& a, const Process& b) { return a.heard < b.heard; }));
    }
    processes_.push_back({status.name, status.host, 0, now, {}});
    known = processes_.end() - 1;
  }
  known->seq = status.seq;
  known->heard = now;
  known->offsets_us.push_back(status.utime - wall_utime);
  if (known->offsets_us.size() > kOffsets) known->offsets_us.pop_front();
  return is_new;
}

void PeerProcesses::note(const ConfigNotice& notice, Clock::time_point now) {
  if (configs_.size() >= kProcessesMax && configs_.count(notice.name) == 0) configs_.clear();
  configs_[notice.name] = {notice.hash, now};
}

double PeerProcesses::check_clock(std::int64_t wall_utime, Clock::time_point now) {
  const std::int64_t base_us =
      wall_utime -
      std::chrono::duration_cast<std::chrono::microseconds>(now.time_since_epoch()).count();
  const std::int64_t step_us = has_clock_base_ ? base_us - clock_base_us_ : 0;
  has_clock_base_ = true;
  clock_base_us_ = base_us;
  if (std::llabs(step_us) < kClockStep_us) return 0.0;
  clock_step_s_ = 1e-6 * static_cast<double>(step_us);
  clock_step_time_ = now;
  for (Process& process : processes_) process.offsets_us.clear();
  return clock_step_s_;
}

const PeerProcesses::Process* PeerProcesses::find_duplicate(Clock::time_point now) const {
  for (const Process& process : processes_) {
    if (process.name == name_ && now - process.heard <= kGoneAfter) return &process;
  }
  return nullptr;
}

std::string PeerProcesses::duplicate(Clock::time_point now) const {
  const Process* duplicate = find_duplicate(now);
  return duplicate == nullptr ? "" : duplicate->name + " on " + duplicate->host;
}

bool PeerProcesses::duplicate_is_older(std::int32_t own_seq, Clock::time_point now) const {
  const Process* duplicate = find_duplicate(now);
  return duplicate != nullptr &&
         (duplicate->seq > own_seq || (duplicate->seq == own_seq && duplicate->host < host_));
}

std::string PeerProcesses::named(const std::string& part, Clock::time_point now) const {
  std::string text;
  for (const Process& process : processes_) {
    if (now - process.heard > kGoneAfter) continue;
    if (process.name.find(part) == std::string::npos) continue;
    text += (text.empty() ? "" : ", ") + process.name + " on " + process.host;
  }
  return text;
}

std::string PeerProcesses::text(Clock::time_point now) const {
  std::string text;
  for (const auto& [name, config] : configs_) {
    if (config.hash == config_hash_ || now - config.heard > kConfigGoneAfter) continue;
    const std::string who = named(name, now);
    append(text, "another configuration is used by " + (who.empty() ? name : who));
  }
  for (const Process& process : processes_) {
    if (now - process.heard > kGoneAfter || process.offsets_us.size() < kOffsets) continue;
    if (machine_of(process.host) == machine_of(host_)) continue;  // it has the same clock
    // Transport only delays a message, so the fastest one gives the best offset.
    const std::int64_t offset_us =
        *std::max_element(process.offsets_us.begin(), process.offsets_us.end());
    if (std::llabs(offset_us) < kSkew_us) continue;
    append(text, "the clock of " + machine_of(process.host) + " is " +
                     fixed_text(1e-6 * static_cast<double>(std::llabs(offset_us)), 1) + " s " +
                     (offset_us > 0 ? "ahead of" : "behind") + " this machine's (seen from " +
                     process.name + ")");
  }
  if (clock_step_s_ != 0.0 && now - clock_step_time_ <= kClockStepSaid) {
    append(text, "the clock of this machine was changed by " + fixed_text(clock_step_s_, 1) + " s");
  }
  return text;
}

}  // namespace orchard::bus
