// SPDX-License-Identifier: BSD-3-Clause
#include "device/scip/scip_protocol.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace orchard::device {
namespace {

/// The time stamp: 24 bits of milliseconds (SCIP 2.0, 8.1), which wrap every 4 h 40 min.
constexpr int kClock_bits = 24;
constexpr double kTick_us = 1000.0;

/// Turns without a sweep, besides half a second for a busy host, after which sweeps count as
/// missing.
constexpr double kMaxSilence_turns = 5.0;

/// Number of clock readings. Each narrows the bounds; together they resolve a fraction of a
/// millisecond.
constexpr int kNumReadings = 12;

constexpr std::array<std::string_view, 7> kCommands = {"QT", "PP", "II", "TM0", "TM1", "TM2", "BM"};

}  // namespace

ScipProtocol::ScipProtocol() : ScannerSession(kClock_bits, kTick_us) {}

void ScipProtocol::connected(std::int64_t host_utime) {
  reset_session();
  parameters_.reset();
  ask(Step::kStop, host_utime);
}

void ScipProtocol::ask(Step step, std::int64_t host_utime) {
  step_ = step;
  num_asked_ = 0;
  command_ = kCommands[static_cast<std::size_t>(step)];
  ask_again(host_utime);
}

void ScipProtocol::ask_again(std::int64_t host_utime) { send(command_ + "\n", host_utime); }

void ScipProtocol::begin_stream(ScipEncoding encoding, std::int64_t host_utime) {
  encoding_ = encoding;
  step_ = Step::kStream;
  num_asked_ = 0;
  is_granted_ = false;
  const char letter = encoding == ScipEncoding::kTwo     ? 'S'
                      : encoding == ScipEncoding::kThree ? 'D'
                                                         : 'E';
  // All beams, none merged, every sweep, without limit.
  std::array<char, 32> command{};
  std::snprintf(command.data(), command.size(), "M%c%04d%04d00000", letter, parameters_->first_step,
                parameters_->last_step);
  command_ = command.data();
  // Until its clock has been read, a sweep is assumed to arrive as soon as it is complete.
  ask_again(host_utime);
}

void ScipProtocol::receive(std::string_view bytes, std::int64_t host_utime) {
  buffer_ += bytes;
  std::size_t begin = 0;
  for (std::size_t end; (end = buffer_.find("\n\n", begin)) != std::string::npos;) {
    const std::string text = buffer_.substr(begin, end - begin);
    begin = end + 2;
    const auto reply = parse_scip_reply(text);
    if (reply && is_answer(reply->echo)) {
      take(*reply, host_utime);
    } else if (step_ == Step::kStream) {
      ++counts_.num_bad;  // until then, replies may belong to an earlier connection
    }
  }
  buffer_.erase(0, begin);
  bound_buffer();
}

bool ScipProtocol::is_answer(std::string_view echo) const {
  if (step_ != Step::kStream) return echo == command_;
  // The last two digits count the remaining sweeps.
  const std::size_t num_fixed = command_.size() - 2;
  return echo.size() == command_.size() &&
         echo.substr(0, num_fixed) == std::string_view(command_).substr(0, num_fixed);
}

void ScipProtocol::take(const ScipReply& reply, std::int64_t host_utime) {
  switch (step_) {
    case Step::kStop:
      return ask(Step::kParameters, host_utime);
    case Step::kParameters:
      return take_parameters(reply, host_utime);
    case Step::kState:
      if (const auto rpm = parse_scip_motor_rpm(reply.body)) parameters_->rate_rpm = *rpm;
      return ask(Step::kClockIn, host_utime);
    case Step::kClockIn:
      num_readings_ = 0;
      // Status 02: already in this mode. Any other: the scanner has no such mode.
      return ask(reply.status == "00" || reply.status == "02" ? Step::kClockRead : Step::kLaser,
                 host_utime);
    case Step::kClockRead:
      return take_clock_reading(reply, host_utime);
    case Step::kClockOut:
      return ask(Step::kLaser, host_utime);
    case Step::kLaser:
      // Status 02: already on. 01: the laser fails to turn on and no sweep will follow.
      if (reply.status == "01")
        trouble_ = "the laser of the scanner does not switch on (status 01)";
      return begin_stream(parameters_->fits_two_characters() ? ScipEncoding::kTwo
                                                             : ScipEncoding::kThreeWithIntensity,
                          host_utime);
    case Step::kStream:
      return take_stream(reply, host_utime);
  }
}

void ScipProtocol::take_parameters(const ScipReply& reply, std::int64_t host_utime) {
  parameters_ = parse_scip_parameters(reply.body);
  if (parameters_) {
    const double last_beam_us = parameters_->last_step * parameters_->beam_period_us();
    clock_.set_min_delay(last_beam_us);
    return ask(Step::kState, host_utime);
  }
  ++counts_.num_bad;
  if (num_asked_ < kMaxAsked) return ask_again(host_utime);
  fail("the parameters of the scanner (reply to PP) are invalid");
}

void ScipProtocol::take_clock_reading(const ScipReply& reply, std::int64_t host_utime) {
  const auto time = reply.body.empty() ? std::nullopt : checked_line(reply.body.front());
  const auto ticks = time && time->size() == 4 ? scip_number(*time) : std::nullopt;
  if (ticks) {
    clock_.read_between(*ticks, asked_utime_, host_utime);
  } else {
    ++counts_.num_bad;
  }
  if (++num_readings_ < kNumReadings) return ask(Step::kClockRead, host_utime);
  ask(Step::kClockOut, host_utime);
}

void ScipProtocol::take_stream(const ScipReply& reply, std::int64_t host_utime) {
  if (reply.status == "99") return take_sweep(reply, host_utime);
  if (reply.status == "00") {
    is_granted_ = true;
    deadline_utime_ = host_utime + kFirstSweep_us;
    return;
  }
  refuse_stream(reply.status, host_utime);
}

void ScipProtocol::refuse_stream(std::string_view status, std::int64_t host_utime) {
  if (!is_granted_ && encoding_ == ScipEncoding::kThreeWithIntensity) {
    return begin_stream(ScipEncoding::kThree, host_utime);  // a model without intensities
  }
  if (status >= "21" && status <= "98") {
    trouble_ = "the scanner reports status " + std::string(status) +
               (status == "98"  ? ": it resumes after a self-test"
                : status < "50" ? ": it stopped because of an error"
                                : ": hardware fault (laser, motor)");
    return;
  }
  ++counts_.num_bad;
  if (!is_granted_) fail("the scanner refuses " + command_ + ": status " + std::string(status));
}

void ScipProtocol::take_sweep(const ScipReply& reply, std::int64_t host_utime) {
  auto sweep = parse_scip_sweep(reply.body, *parameters_, encoding_);
  if (!sweep) {
    ++counts_.num_bad;
    return;
  }
  is_granted_ = is_streaming_ = true;
  trouble_.clear();
  deadline_utime_ = host_utime + kAnswer_us +
                    static_cast<std::int64_t>(kMaxSilence_turns * parameters_->turn_us());
  const double step_0_us = clock_.arrived(sweep->ticks, host_utime);
  const double first_beam_us = parameters_->first_step * parameters_->beam_period_us();
  sweep->scan.utime = clock_.host_utime(step_0_us + first_beam_us);
  take_scan(std::move(sweep->scan));
}

void ScipProtocol::expire(std::int64_t host_utime) {
  switch (step_) {
    case Step::kState:
      return ask(Step::kClockIn, host_utime);  // can do without
    case Step::kClockIn:
      return ask(Step::kLaser, host_utime);  // can do without
    case Step::kLaser:
      return begin_stream(ScipEncoding::kThree, host_utime);
    case Step::kStream:
      if (!is_granted_ && encoding_ == ScipEncoding::kThreeWithIntensity) {
        return begin_stream(ScipEncoding::kThree, host_utime);
      }
      if (!is_granted_) break;
      if (may_restart()) ask(Step::kStop, host_utime);
      return;
    default:
      break;
  }
  if (num_asked_ >= kMaxAsked) {
    return fail(trouble_.empty()
                    ? "no answer to " + command_ + "; check that it is a scanner with SCIP 2.0"
                    : trouble_);
  }
  // A URG-04LX starts in SCIP 1.1; other models answer the switch with an error, which is ignored.
  // The empty line ends a command that a broken connection may have left incomplete.
  if (step_ == Step::kStop) to_send_ += "\nSCIP2.0\n";
  ask_again(host_utime);
}

}  // namespace orchard::device
