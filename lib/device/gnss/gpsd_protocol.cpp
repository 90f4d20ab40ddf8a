// SPDX-License-Identifier: BSD-3-Clause
#include "device/gnss/gpsd_protocol.hpp"

#include <cmath>
#include <utility>
#include <variant>

#include "device/gnss/gnss_fix.hpp"
#include "text/number_text.hpp"

namespace orchard::device {
namespace {

constexpr std::size_t kLongestLine_bytes = 32768;  // SKY of a receiver of four systems: about 15 kB
constexpr std::int64_t kSilence_us = 2'000'000;
constexpr int kMaxUnanswered = 5;
constexpr std::int64_t kNoiseAge_us = 1'500'000;
constexpr double kImplausibleLead_s = 2.0;
constexpr std::size_t kShownBytes = 60;

std::string shown(std::string_view bytes) {
  std::string text;
  for (const char byte : bytes.substr(0, kShownBytes)) {
    text += byte >= ' ' && byte <= '~' ? byte : '?';
  }
  return text;
}

/// A JSON string literal: quotes and backslashes escaped.
std::string quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char byte : text) {
    if (byte == '"' || byte == '\\') quoted += '\\';
    if (byte >= ' ') quoted += byte;
  }
  return quoted + '"';
}

}  // namespace

GpsdProtocol::GpsdProtocol(const GnssDriverConfig& config)
    : config_(config), lines_(kLongestLine_bytes), clock_(32, 1.0), receiver_(config.receiver) {
  clock_.set_min_delay(1e6 * config.latency_s);
}

void GpsdProtocol::connected(std::int64_t host_utime) {
  lines_.restart(false);
  clock_.begin_connection();
  noise_.reset();
  has_receivers_.reset();
  error_.clear();
  why_no_fix_.clear();
  num_unanswered_ = 0;
  fix_utime_ = 0;
  deadline_ = host_utime + kSilence_us;
  // gpsd_json(5): ?WATCH. With "device" gpsd sends the reports of that receiver only.
  to_send_ = "?WATCH={\"enable\":true,\"json\":true" +
             (config_.receiver.empty() ? "" : ",\"device\":" + quoted(config_.receiver)) + "};\n";
}

void GpsdProtocol::receive(std::string_view bytes, std::int64_t host_utime) {
  lines_.add(bytes, [&](std::string_view line) { take_line(line, host_utime); });
}

void GpsdProtocol::expire(std::int64_t host_utime) {
  // gpsd says nothing when a receiver is unplugged: request the list of devices.
  to_send_ += "?DEVICES;\n";
  ++num_unanswered_;
  deadline_ = host_utime + kSilence_us;
  if (host_utime - fix_utime_ < kSilence_us) return;
  fix_utime_ = 0;
  why_no_fix_ = "gpsd sends no fixes; check that the receiver is still plugged in";
}

void GpsdProtocol::host_clock_stepped(std::int64_t step_us) {
  clock_.host_stepped(step_us);
  last_utime_ += step_us;
  if (fix_utime_ != 0) fix_utime_ += step_us;
  if (deadline_) *deadline_ += step_us;
}

std::string GpsdProtocol::failure() const {
  return num_unanswered_ > kMaxUnanswered ? "gpsd does not answer any more" : "";
}

std::string GpsdProtocol::condition() const {
  if (!error_.empty()) return "gpsd reports: " + error_;
  if (fix_utime_ == 0) {
    if (has_receivers_ == false) {
      return "gpsd has no receiver; check that it is plugged in and that gpsd was started with its "
             "device";
    }
    if (!why_no_fix_.empty()) return why_no_fix_;
    return "waits for the first report" + (receiver_.empty() ? "" : " of " + shown(receiver_));
  }
  if (std::abs(fix_lead_s_) > kImplausibleLead_s) {
    return "fixes arrive " + fixed_text(fix_lead_s_, 1) +
           " s after their own time stamp: the clock of this machine is not synchronised to "
           "satellite time; use drivers.gnss.stamp: receipt";
  }
  if (num_other_receivers_ > 0) {
    return "reads " + shown(receiver_) +
           " only, but gpsd has several receivers; choose one with drivers.gnss.receiver";
  }
  return {};
}

ProtocolCounts GpsdProtocol::counts() const {
  ProtocolCounts counts = counts_;
  counts.num_bad += lines_.num_too_long();
  return counts;
}

void GpsdProtocol::take_line(std::string_view line, std::int64_t host_utime) {
  const GpsdReport report = parse_gpsd_report(line);
  if (std::holds_alternative<GpsdBad>(report)) {
    ++counts_.num_bad;
    return;
  }
  ++counts_.num_good;
  num_unanswered_ = 0;
  if (const auto* devices = std::get_if<GpsdDevices>(&report)) {
    has_receivers_ = !devices->paths.empty();
  } else if (const auto* error = std::get_if<GpsdError>(&report)) {
    error_ = shown(error->message);
  } else if (const auto* noise = std::get_if<GpsdNoise>(&report)) {
    if (!is_ours(noise->device)) return;
    noise_ = *noise;
    noise_status_ = last_status_;
  } else if (const auto* fix = std::get_if<GpsdFix>(&report)) {
    if (is_ours(fix->device)) take_fix(*fix, host_utime);
  }
}

bool GpsdProtocol::is_ours(const std::string& device) {
  if (receiver_.empty()) receiver_ = device;
  if (device == receiver_) return true;
  ++num_other_receivers_;
  return false;
}

void GpsdProtocol::take_fix(const GpsdFix& fix, std::int64_t host_utime) {
  has_receivers_ = true;
  deadline_ = host_utime + kSilence_us;
  std::optional<pose::Gnss> gnss = to_measurement(fix, noise_of(fix));
  last_status_ = fix.status;
  if (!gnss || !fix.time_us) {
    fix_utime_ = 0;
    why_no_fix_ = "the receiver has no fix yet" + std::string(gnss ? ": no time" : "");
    return;
  }
  // gpsd reports after each NMEA sentence: a later report has the height.
  if (fix.mode == 3 && !fix.altitude_m) {
    if (fix_utime_ == 0) why_no_fix_ = "waits for a fix with an altitude";
    return;
  }
  fix_utime_ = host_utime;
  error_.clear();
  // gpsd repeats a fix whenever more of its fields are known.
  if (last_fix_time_us_ == fix.time_us) return;
  last_fix_time_us_ = fix.time_us;
  gnss->utime = stamp(*fix.time_us, host_utime);
  if (gnss->utime <= last_utime_) gnss->utime = last_utime_ + 1;
  last_utime_ = gnss->utime;
  measurements_.emplace_back(*gnss);
}

std::int64_t GpsdProtocol::stamp(std::int64_t fix_time_us, std::int64_t host_utime) {
  if (config_.stamp == GnssStamp::kFixTime) {
    fix_lead_s_ = 1e-6 * static_cast<double>(host_utime - fix_time_us);
    return fix_time_us;
  }
  return clock_.host_utime(clock_.arrived(static_cast<std::uint32_t>(fix_time_us), host_utime));
}

const GpsdNoise* GpsdProtocol::noise_of(const GpsdFix& fix) const {
  if (!noise_ || !noise_->time_us || !fix.time_us) return nullptr;
  if (*noise_->time_us == *fix.time_us) return &*noise_;
  // The noise of the fix before applies while the status is the same.
  const std::int64_t age_us = *fix.time_us - *noise_->time_us;
  const bool is_near = age_us > 0 && age_us <= kNoiseAge_us;
  return is_near && noise_status_ == fix.status ? &*noise_ : nullptr;
}

}  // namespace orchard::device
