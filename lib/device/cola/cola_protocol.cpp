// SPDX-License-Identifier: BSD-3-Clause
#include "device/cola/cola_protocol.hpp"

#include <array>

#include "device/cola/cola_fields.hpp"

namespace orchard::device {
namespace {

constexpr char kStx = '\x02';
constexpr char kEtx = '\x03';

/// The clock of a telegram: 32 bits of microseconds, which wrap every 71.6 minutes.
constexpr int kClock_bits = 32;
constexpr double kTick_us = 1.0;

/// Time without a sweep after which the dialogue restarts; the slowest of these scanners sends one
/// every 67 ms.
constexpr std::int64_t kMaxSilence_us = 1'000'000;

struct Question {
  std::string_view command;
  std::string_view answer;  ///< prefix of the telegram that grants it
};

constexpr std::array<Question, 7> kQuestions = {{
    {"sEN LMDscandata 0", "sEA LMDscandata"},
    {"sRN DeviceIdent", "sRA DeviceIdent "},
    {"sRN LMPoutputRange", "sRA LMPoutputRange "},
    // Log in as "authorised client" with the factory password. Nothing is saved in the device: its
    // settings return after a power cycle.
    {"sMN SetAccessMode 03 F4724744", "sAN SetAccessMode 1"},
    // First echo, intensities in 16 bits; no encoder, position, name, comment, time; every sweep.
    {"sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +1", "sWA LMDscandatacfg"},
    {"sMN Run", "sAN Run"},
    {"sEN LMDscandata 1", "sEA LMDscandata"},
}};

bool begins_with(std::string_view text, std::string_view begin) {
  return text.substr(0, begin.size()) == begin;
}

/// True if the telegram is an answer: to a read, a write, a method, an event, or a refusal.
bool is_answer(std::string_view telegram) {
  for (const std::string_view kind : {"sRA ", "sWA ", "sAN ", "sEA ", "sFA "}) {
    if (begins_with(telegram, kind)) return true;
  }
  return false;
}

/// The name in "sRA DeviceIdent 10 LMS10x_FieldEval 10 V1.36-21.10.2010"; each text follows its
/// length.
std::string_view name_in_ident(std::string_view telegram) {
  ColaFields fields(telegram);
  fields.skip(3);
  return fields.text();
}

}  // namespace

ColaProtocol::ColaProtocol() : ScannerSession(kClock_bits, kTick_us) {}

void ColaProtocol::connected(std::int64_t host_utime) {
  reset_session();
  model_ = {};
  range_.reset();
  ask(Step::kStop, host_utime);
}

void ColaProtocol::ask(Step step, std::int64_t host_utime) {
  step_ = step;
  num_asked_ = 0;
  if (step == Step::kStream) {
    deadline_utime_ = host_utime + kFirstSweep_us;
    return;
  }
  command_ = kQuestions[static_cast<std::size_t>(step)].command;
  ask_again(host_utime);
}

void ColaProtocol::ask_again(std::int64_t host_utime) { send(kStx + command_ + kEtx, host_utime); }

/// Goes to the next step; without the log-in, two steps are skipped.
void ColaProtocol::go_on(bool was_granted, std::int64_t host_utime) {
  const bool skips = step_ == Step::kLogin && !was_granted;
  ask(skips ? Step::kStart : static_cast<Step>(static_cast<int>(step_) + 1), host_utime);
}

void ColaProtocol::receive(std::string_view bytes, std::int64_t host_utime) {
  buffer_ += bytes;
  std::size_t begin = 0;
  for (std::size_t end; (end = buffer_.find(kEtx, begin)) != std::string::npos;) {
    const std::size_t stx = buffer_.rfind(kStx, end);
    if (stx != std::string::npos && stx >= begin) {
      take(std::string_view(buffer_).substr(stx + 1, end - stx - 1), host_utime);
    } else {
      ++counts_.num_bad;
    }
    begin = end + 1;
  }
  buffer_.erase(0, begin);
  bound_buffer();
}

void ColaProtocol::take(std::string_view telegram, std::int64_t host_utime) {
  if (begins_with(telegram, "sSN LMDscandata ")) {
    // Sweeps that arrive before the stop belong to an earlier connection.
    if (step_ == Step::kStart || step_ == Step::kStream) take_sweep(telegram, host_utime);
    return;
  }
  if (step_ == Step::kStream) {
    if (!is_answer(telegram)) ++counts_.num_bad;
    return;
  }
  if (begins_with(telegram, kQuestions[static_cast<std::size_t>(step_)].answer)) {
    if (step_ == Step::kIdentify) model_ = cola_model(name_in_ident(telegram));
    if (step_ == Step::kRange) range_ = parse_cola_range(telegram);
    return go_on(true, host_utime);
  }
  // "sFA 3" is a refusal, and so is the answer 0 to the log-in.
  const bool is_refusal = begins_with(telegram, "sFA") || begins_with(telegram, "sAN");
  if (!is_refusal) return;
  if (step_ == Step::kStop || step_ == Step::kStart) {
    return fail("the scanner refuses " + command_ + ": " + std::string(telegram.substr(0, 20)));
  }
  go_on(false, host_utime);
}

void ColaProtocol::take_sweep(std::string_view telegram, std::int64_t host_utime) {
  auto sweep = parse_cola_scan(telegram, model_, range_);
  if (!sweep || sweep->has_error) {
    if (sweep) trouble_ = "the scanner reports an internal error: its scans are not used";
    ++counts_.num_bad;
    return;
  }
  if (step_ == Step::kStart) ask(Step::kStream, host_utime);  // a sweep arrived before the answer
  is_streaming_ = true;
  trouble_ = sweep->is_dirty ? "the scanner reports a dirty front screen; clean it" : "";
  deadline_utime_ = host_utime + kMaxSilence_us;
  // The clock is synchronised by the time of transmission, since only the network delay separates
  // it from the arrival.
  const double sent_us = clock_.arrived(sweep->sent_ticks, host_utime);
  const double start_us = sent_us - kTick_us * (sweep->sent_ticks - sweep->start_ticks);
  sweep->scan.utime = clock_.host_utime(start_us + sweep->to_first_beam_us);
  take_scan(std::move(sweep->scan));
}

void ColaProtocol::expire(std::int64_t host_utime) {
  if (step_ == Step::kStream) {
    if (may_restart()) ask(Step::kStop, host_utime);
    return;
  }
  if (step_ != Step::kStop && step_ != Step::kStart) return go_on(false, host_utime);
  if (num_asked_ < kMaxAsked) return ask_again(host_utime);
  fail("no answer to " + command_ +
       "; check that it is a scanner with CoLa-A and the port is 2111 or 2112");
}

}  // namespace orchard::device
