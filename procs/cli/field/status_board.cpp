// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/status_board.hpp"

#include <algorithm>
#include <iterator>

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
  const auto machine = [](const std::string& host) { return host.substr(0, host.rfind(':')); };
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    const bool same = entry->first.second == status.name &&
                      machine(entry->first.first) == machine(status.host) &&
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
    view.clock_offset_s = 1e-6 * static_cast<double>(*std::max_element(entry.offsets_us.begin(),
                                                                       entry.offsets_us.end()));
    view.num_new_lost = entry.num_new_lost;
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace orchard::cli
