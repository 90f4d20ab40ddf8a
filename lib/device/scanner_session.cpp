// SPDX-License-Identifier: BSD-3-Clause
#include "device/scanner_session.hpp"

#include <utility>

namespace orchard::device {

void ScannerSession::reset_session() {
  buffer_.clear();
  to_send_.clear();
  failure_.clear();
  trouble_.clear();
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

void ScannerSession::bound_buffer() {
  if (buffer_.size() <= kMaxReply) return;
  buffer_.clear();
  ++counts_.num_bad;
}

bool ScannerSession::may_restart() {
  if (trouble_.empty()) trouble_ = "the scanner sends no scans";
  if (!is_streaming_) {
    fail(trouble_);
    return false;
  }
  is_streaming_ = false;
  buffer_.clear();
  clock_.begin_connection();
  return true;
}

void ScannerSession::take_scan(laser::Scan scan) {
  if (last_utime_ && scan.utime <= *last_utime_) {
    ++counts_.num_bad;
    return;
  }
  last_utime_ = scan.utime;
  ++counts_.num_good;
  measurements_.emplace_back(std::move(scan));
}

void ScannerSession::host_clock_stepped(std::int64_t step_us) {
  clock_.host_stepped(step_us);
  asked_utime_ += step_us;
  if (last_utime_) *last_utime_ += step_us;
  if (deadline_utime_) *deadline_utime_ += step_us;
}

std::string ScannerSession::condition() const {
  if (!failure_.empty()) return failure_;
  if (!trouble_.empty()) return trouble_;
  if (num_asked_ > 1) return "waits for the scanner's answer to " + command_;
  return is_streaming_ ? std::string() : "waits for the scanner's first scan";
}

}  // namespace orchard::device
