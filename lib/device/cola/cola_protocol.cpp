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

constexpr std::int64_t kAnswer_us = 500'000;
constexpr int kMaxAsked = 3;

/// The slowest of these scanners sends a sweep every 67 ms.
constexpr std::int64_t kMaxSilence_us = 1'000'000;

/// One that was just started needs seconds.
constexpr std::int64_t kFirstSweep_us = 6'000'000;

/// 10,000 beams with intensities in up to four digits and a blank each.
constexpr std::size_t kMaxTelegram = 128 * 1024;

struct Question {
  std::string_view command;
  std::string_view answer;  ///< how a telegram that grants it begins
};

constexpr std::array<Question, 7> kQuestions = {{
    {"sEN LMDscandata 0", "sEA LMDscandata"},
    {"sRN DeviceIdent", "sRA DeviceIdent "},
    {"sRN LMPoutputRange", "sRA LMPoutputRange "},
    // As "authorised client", with the password that these devices are delivered with. Nothing is
    // saved in the device: when it is switched off, it is as before.
    {"sMN SetAccessMode 03 F4724744", "sAN SetAccessMode 1"},
    // First echo, intensities in 16 bits; no encoder, position, name, comment, time; every sweep.
    {"sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +1", "sWA LMDscandatacfg"},
    {"sMN Run", "sAN Run"},
    {"sEN LMDscandata 1", "sEA LMDscandata"},
}};

bool begins_with(std::string_view text, std::string_view begin) {
  return text.substr(0, begin.size()) == begin;
}

/// One of those a scanner gives: to reading, to writing, to a method, to an event, or a refusal.
bool is_answer(std::string_view telegram) {
  for (const std::string_view kind : {"sRA ", "sWA ", "sAN ", "sEA ", "sFA "}) {
    if (begins_with(telegram, kind)) return true;
  }
  return false;
}

/// "sRA DeviceIdent 10 LMS10x_FieldEval 10 V1.36-21.10.2010": each text after its length.
std::string_view name_in_ident(std::string_view telegram) {
  ColaFields fields(telegram);
  fields.skip(3);
  return fields.text();
}

}  // namespace

ColaProtocol::ColaProtocol() : clock_(kClock_bits, kTick_us) {}

void ColaProtocol::connected(std::int64_t host_utime) {
  buffer_.clear();
  to_send_.clear();
  failure_.clear();
  trouble_.clear();
  model_ = {};
  range_.reset();
  is_streaming_ = false;
  clock_.begin_talk();
  ask(Step::kStop, host_utime);
}

void ColaProtocol::fail(const std::string& why) {
  failure_ = why;
  deadline_utime_.reset();
}

void ColaProtocol::ask(Step step, std::int64_t host_utime) {
  step_ = step;
  num_asked_ = 0;
  if (step == Step::kStream) {
    deadline_utime_ = host_utime + kFirstSweep_us;
  } else {
    ask_again(host_utime);
  }
}

void ColaProtocol::ask_again(std::int64_t host_utime) {
  ++num_asked_;
  to_send_ += kStx;
  to_send_ += kQuestions[static_cast<std::size_t>(step_)].command;
  to_send_ += kEtx;
  deadline_utime_ = host_utime + kAnswer_us;
}

/// To the next step; without the log-in two are of no use.
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
  if (buffer_.size() > kMaxTelegram) {
    buffer_.clear();
    ++counts_.num_bad;
  }
}

void ColaProtocol::take(std::string_view telegram, std::int64_t host_utime) {
  if (begins_with(telegram, "sSN LMDscandata ")) {
    // Before it has been stopped, what comes belongs to an earlier talk.
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
  // "sFA 3" is a refusal, as is the answer to the log-in with 0.
  const bool is_refusal = begins_with(telegram, "sFA") || begins_with(telegram, "sAN");
  if (!is_refusal) return;
  if (step_ == Step::kStop || step_ == Step::kStart) {
    return fail("the scanner refuses " +
                std::string(kQuestions[static_cast<std::size_t>(step_)].command) + ": " +
                std::string(telegram.substr(0, 20)));
  }
  go_on(false, host_utime);
}

void ColaProtocol::take_sweep(std::string_view telegram, std::int64_t host_utime) {
  auto sweep = parse_cola_scan(telegram, model_, range_);
  if (!sweep || sweep->has_error) {
    if (sweep) trouble_ = "the scanner reports an error of its own: its sweeps are not used";
    ++counts_.num_bad;
    return;
  }
  if (step_ == Step::kStart) ask(Step::kStream, host_utime);  // the sweep overtook the answer
  is_streaming_ = true;
  trouble_ = sweep->is_dirty ? "the scanner says that its front screen is dirty" : "";
  deadline_utime_ = host_utime + kMaxSilence_us;
  // The clock is tied by the time of sending, which the network alone separates from arrival.
  const double sent_us = clock_.arrived(sweep->sent_ticks, host_utime);
  const double start_us = sent_us - kTick_us * (sweep->sent_ticks - sweep->start_ticks);
  sweep->scan.utime = clock_.host_utime(start_us + sweep->to_first_beam_us);
  if (last_utime_ && sweep->scan.utime <= *last_utime_) {
    ++counts_.num_bad;  // a counter that jumped: two sweeps cannot be of one time
    return;
  }
  last_utime_ = sweep->scan.utime;
  ++counts_.num_good;
  measurements_.emplace_back(std::move(sweep->scan));
}

void ColaProtocol::expire(std::int64_t host_utime) {
  if (step_ == Step::kStream) {
    if (trouble_.empty()) trouble_ = "the scanner sends no sweeps";
    if (!is_streaming_) return fail(trouble_);
    is_streaming_ = false;
    buffer_.clear();
    clock_.begin_talk();
    return ask(Step::kStop, host_utime);
  }
  if (step_ != Step::kStop && step_ != Step::kStart) return go_on(false, host_utime);
  if (num_asked_ < kMaxAsked) return ask_again(host_utime);
  fail("no answer to " + std::string(kQuestions[static_cast<std::size_t>(step_)].command) +
       " (a scanner with CoLa-A? The port is 2111 or 2112)");
}

void ColaProtocol::host_clock_stepped(std::int64_t step_us) {
  clock_.host_stepped(step_us);
  if (last_utime_) *last_utime_ += step_us;
  if (deadline_utime_) *deadline_utime_ += step_us;
}

std::string ColaProtocol::condition() const {
  if (!failure_.empty()) return failure_;
  if (!trouble_.empty()) return trouble_;
  if (step_ != Step::kStream && num_asked_ > 1) {
    return "waits for the scanner's answer to " +
           std::string(kQuestions[static_cast<std::size_t>(step_)].command);
  }
  return is_streaming_ ? std::string() : "waits for the scanner's first sweep";
}

}  // namespace orchard::device
