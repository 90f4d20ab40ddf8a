// SPDX-License-Identifier: BSD-3-Clause
#include "device/scanner_session.hpp"

#include <utility>

namespace orchard::device {

void ScannerSession::reset_session() {
  buffer_.clear();
  to_send_.clear();
  failure_.clear();
  trouble_ = {};
  is_streaming_ = false;
  clock_.begin_connection();
}

void ScannerSession::send(const std::string& framed, std::int64_t host_utime) {
  ++num_asked_;
  to_send_ += framed;
  asked_utime_ = host_utime;
  deadline_utime_ = host_utime + kAnswer_us;
}

void ScannerSession::fail(const std::string& why) {
  failure_ = why;
  deadline_utime_.reset();
}

void ScannerSession::bound_buffer(std::int64_t host_utime) {
  if (buffer_.size() <= kMaxReply) return;
  buffer_.clear();
  units_.add_refused(host_utime, "a telegram without an end");
}

bool ScannerSession::may_restart() {
  if (trouble_.text.empty()) trouble_ = {Severity::kError, "the scanner sends no scans"};
  if (!is_streaming_) {
    fail(trouble_.text);
    return false;
  }
  is_streaming_ = false;
  buffer_.clear();
  clock_.begin_connection();
  return true;
}

void ScannerSession::take_scan(laser::Scan scan, std::int64_t host_utime) {
  scan.utime -= delay_us_;
  if (last_utime_ && scan.utime <= *last_utime_) {
    return units_.add_refused(host_utime, "its time is not later than that of the sweep before");
  }
  last_utime_ = scan.utime;
  units_.add_good(host_utime);
  measurements_.emplace_back(std::move(scan));
}

void ScannerSession::host_clock_stepped(std::int64_t step_us) {
  clock_.host_stepped(step_us);
  units_.host_clock_stepped();
  asked_utime_ += step_us;
  if (last_utime_) *last_utime_ += step_us;
  if (deadline_utime_) *deadline_utime_ += step_us;
}

Condition ScannerSession::condition() const {
  if (!failure_.empty()) return {Severity::kError, failure_};
  Condition condition = trouble_;
  condition.add(Severity::kWarning, units_.warning("sweeps"));
  if (!condition.text.empty()) return condition;
  if (num_asked_ > 1) {
    return {Severity::kWaiting, "waits for the scanner's answer to " + command_};
  }
  if (!is_streaming_) return {Severity::kWaiting, "waits for the scanner's first scan"};
  return {Severity::kNone, note()};
}

}  // namespace orchard::device
