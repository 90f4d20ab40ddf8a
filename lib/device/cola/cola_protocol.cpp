// SPDX-License-Identifier: BSD-3-Clause
#include "device/cola/cola_protocol.hpp"

#include <array>
#include <utility>

namespace orchard::device {
namespace {

using std::string_view_literals::operator""sv;

/// The clock of a telegram: 32 bits of microseconds, which wrap every 71.6 minutes.
constexpr int kClock_bits = 32;
constexpr double kTick_us = 1.0;

/// Time without a sweep after which the dialogue restarts; the slowest of these scanners sends one
/// every 67 ms.
constexpr std::int64_t kMaxSilence_us = 1'000'000;

/// A command, and its parameters in each dialect.
struct Question {
  std::string_view command;
  std::string_view text;
  std::string_view bytes;
};

constexpr std::array<Question, 7> kQuestions = {{
    {"sEN LMDscandata", "0", "\0"sv},
    {"sRN DeviceIdent", "", ""},
    {"sRN LMPoutputRange", "", ""},
    // Log in as "authorised client" with the factory password. Nothing is saved in the device: its
    // settings return after a power cycle.
    {"sMN SetAccessMode", "03 F4724744", "\x03\xf4\x72\x47\x44"sv},
    // First echo, intensities in 16 bits; no encoder, position, name, comment, time; every sweep.
    {"sWN LMDscandatacfg", "01 00 1 1 0 00 00 0 0 0 0 +1", "\1\0\1\1\0\0\0\0\0\0\0\0\1"sv},
    {"sMN Run", "", ""},
    {"sEN LMDscandata", "1", "\1"sv},
}};

std::string request(const Question& question, ColaDialect dialect) {
  const std::string_view parameters = dialect == ColaDialect::kA ? question.text : question.bytes;
  return std::string(question.command) + (parameters.empty() ? "" : " ") + std::string(parameters);
}

/// True for what a device sends: answers to a read, a write, a method and a subscription, refusals
/// and events.
bool is_known(std::string_view kind) {
  return kind == "sRA" || kind == "sWA" || kind == "sAN" || kind == "sEA" || kind == "sFA" ||
         kind == "sSN";
}

/// The kind that grants a command: "sRA" for "sRN ...".
std::string_view granting_kind(std::string_view command) {
  switch (command[1]) {
    case 'R':
      return "sRA";
    case 'W':
      return "sWA";
    case 'M':
      return "sAN";
    default:
      return "sEA";
  }
}

}  // namespace

ColaProtocol::ColaProtocol() : ScannerSession(kClock_bits, kTick_us) {}

void ColaProtocol::connected(std::int64_t host_utime) {
  reset_session();
  is_noise_ = starts_late_ = false;
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
  ask_again(host_utime);
}

void ColaProtocol::ask_again(std::int64_t host_utime) {
  const Question& question = kQuestions[static_cast<std::size_t>(step_)];
  command_ = question.command;
  send(framed(dialect_, request(question, dialect_)), host_utime);
}

/// Goes to the next step; without the log-in, two steps are skipped.
void ColaProtocol::go_on(bool was_granted, std::int64_t host_utime) {
  const bool skips = step_ == Step::kLogin && !was_granted;
  ask(skips ? Step::kStart : static_cast<Step>(static_cast<int>(step_) + 1), host_utime);
}

void ColaProtocol::receive(std::string_view bytes, std::int64_t host_utime) {
  buffer_ += bytes;
  std::size_t begin = 0;
  while (true) {
    const ColaPiece piece =
        first_piece(dialect_, std::string_view(buffer_).substr(begin), kMaxReply);
    if (piece.kind == ColaPiece::Kind::kIncomplete) break;
    begin += piece.num_bytes;
    take(piece, host_utime);
  }
  buffer_.erase(0, begin);
  bound_buffer(host_utime);
}

void ColaProtocol::take(const ColaPiece& piece, std::int64_t host_utime) {
  const bool was_noise = std::exchange(is_noise_, piece.kind != ColaPiece::Kind::kTelegram);
  if (!is_noise_) return take_telegram(piece.telegram, host_utime);
  // Until the dialect is known, what arrives may be of the other one. What follows a broken
  // telegram is its rest.
  if (step_ == Step::kStop || (was_noise && piece.kind == ColaPiece::Kind::kNoise)) return;
  units_.add_refused(host_utime, piece.kind == ColaPiece::Kind::kNoise
                                     ? "bytes that are no telegram"
                                     : "a telegram that is cut off or has a wrong checksum");
}

void ColaProtocol::take_telegram(std::string_view telegram, std::int64_t host_utime) {
  ColaFields fields(dialect_, telegram);
  const std::string_view kind = fields.word();
  const std::string_view name = fields.word();
  if (kind == "sSN" && name == "LMDscandata") {
    // Sweeps that arrive before the stop belong to an earlier connection.
    if (step_ == Step::kStart || step_ == Step::kStream) take_sweep(fields, host_utime);
  } else if (step_ == Step::kStream) {
    if (!is_known(kind)) units_.add_refused(host_utime, "a telegram of no known kind");
  } else if (kind == granting_kind(command_) && name == command_.substr(4)) {
    take_answer(kind, fields, host_utime);
  } else if (kind == "sFA") {
    if (step_ == Step::kStop || step_ == Step::kStart) {
      return fail("the scanner refuses " + command_);
    }
    go_on(false, host_utime);
  }
}

void ColaProtocol::take_answer(std::string_view kind, ColaFields fields, std::int64_t host_utime) {
  if (step_ == Step::kIdentify) model_ = cola_model(parse_cola_name(fields));
  if (step_ == Step::kRange) range_ = parse_cola_range(fields);
  // A method says in its first field whether it was done.
  go_on(kind != "sAN" || fields.number(1) == 1, host_utime);
}

void ColaProtocol::take_sweep(ColaFields fields, std::int64_t host_utime) {
  auto sweep = parse_cola_scan(fields, model_, range_);
  if (!sweep) return units_.add_refused(host_utime, "a field of LMDscandata is impossible");
  if (sweep->has_error) {
    trouble_ = {Severity::kError, "the scanner reports an internal error: its scans are not used"};
    return units_.add_refused(host_utime, "the scanner reports an internal error");
  }
  if (step_ == Step::kStart) ask(Step::kStream, host_utime);  // a sweep arrived before the answer
  is_streaming_ = true;
  trouble_ = {};
  if (sweep->is_dirty) {
    trouble_ = {Severity::kWarning, "the scanner reports a dirty front screen; clean it"};
  }
  deadline_utime_ = host_utime + kMaxSilence_us;
  // Some send a sweep again when an input or output changes.
  const std::pair number(sweep->num_sent, sweep->start_ticks);
  if (std::exchange(last_number_, number) == number) return;
  sweep->scan.utime = utime_of(*sweep, host_utime);
  take_scan(std::move(sweep->scan), host_utime);
}

/// Time of the first beam. The clock is synchronised by the time of transmission, since only the
/// network delay separates it from the arrival.
std::int64_t ColaProtocol::utime_of(const ColaScan& sweep, std::int64_t host_utime) {
  const double sent_us = clock_.arrived(sweep.sent_ticks, host_utime);
  const double sent_after_us = kTick_us * (sweep.sent_ticks - sweep.start_ticks);
  if (sent_after_us < sweep.to_first_beam_us + sweep.to_last_beam_us) starts_late_ = true;
  return clock_.host_utime(starts_late_ ? sent_us - sweep.to_last_beam_us
                                        : sent_us - sent_after_us + sweep.to_first_beam_us);
}

std::string ColaProtocol::note() const {
  return std::string(name_of(dialect_)) + "; stamped by its " +
         (starts_late_ ? "transmission minus the sweep" : "start of the sweep");
}

void ColaProtocol::expire(std::int64_t host_utime) {
  if (step_ == Step::kStream) {
    if (may_restart()) ask(Step::kStop, host_utime);
    return;
  }
  if (step_ != Step::kStop && step_ != Step::kStart) return go_on(false, host_utime);
  const bool tries_both = step_ == Step::kStop;
  if (num_asked_ < (tries_both ? 2 * kMaxAsked : kMaxAsked)) {
    // A scanner that speaks the other dialect answers nothing.
    if (tries_both) dialect_ = dialect_ == ColaDialect::kA ? ColaDialect::kB : ColaDialect::kA;
    if (tries_both) buffer_.clear();
    return ask_again(host_utime);
  }
  fail("no answer to " + command_ +
       " in CoLa-A and CoLa-B; check that it is a SICK scanner and the port is 2111 or 2112");
}

}  // namespace orchard::device
