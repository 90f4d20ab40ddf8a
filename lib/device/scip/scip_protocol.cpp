// SPDX-License-Identifier: BSD-3-Clause
#include "device/scip/scip_protocol.hpp"
#include "text/parse_number.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <string>

namespace orchard::device {
namespace {

/// Steps are sent as four digits.
constexpr int kMaxStep = 9999;
constexpr int kMinSteps_per_turn = 16;

/// The largest number in three characters.
constexpr int kMaxRange_mm = (1 << 18) - 1;

constexpr int kMinRate_rpm = 60;
constexpr int kMaxRate_rpm = 60000;

std::optional<int> padded_number(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  return parse_number<int>(text);
}

bool is_scanner(const ScipParameters& p) {
  return p.range_min_mm >= 0 && p.range_min_mm < p.range_max_mm && p.range_max_mm <= kMaxRange_mm &&
         p.steps_per_turn >= kMinSteps_per_turn && p.steps_per_turn <= kMaxStep + 1 &&
         p.first_step >= 0 && p.last_step > p.first_step && p.last_step <= kMaxStep &&
         p.num_beams() <= p.steps_per_turn && p.front_step >= 0 && p.front_step <= kMaxStep &&
         p.rate_rpm >= kMinRate_rpm && p.rate_rpm <= kMaxRate_rpm;
}

constexpr std::size_t kCharacters_per_line = 64;
constexpr std::size_t kCharacters_of_time = 4;

/// Converts a range to the scan's units. The limits are converted likewise, so that a range equal
/// to a limit is within it.
float metres(std::int64_t range_mm) {
  return static_cast<float>(1e-3 * static_cast<double>(range_mm));
}

/// Joins the characters of the lines; none when a checksum or the length of a line is wrong.
std::optional<std::string> join_checked(const std::vector<std::string_view>& lines,
                                        std::size_t num_characters) {
  std::string joined;
  joined.reserve(num_characters);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto text = checked_line(lines[i]);
    if (!text || text->size() > kCharacters_per_line) return std::nullopt;
    if (text->size() < kCharacters_per_line && i + 1 < lines.size()) return std::nullopt;
    joined += *text;
    if (joined.size() > num_characters) return std::nullopt;
  }
  if (joined.size() != num_characters) return std::nullopt;
  return joined;
}

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

char scip_sum(std::string_view text) {
  unsigned sum = 0;
  for (const char c : text) sum += static_cast<unsigned char>(c);
  return static_cast<char>((sum & 0x3fu) + 0x30u);
}

std::optional<std::string_view> checked_line(std::string_view line) {
  if (line.size() < 2) return std::nullopt;
  const std::string_view text = line.substr(0, line.size() - 1);
  if (scip_sum(text) != line.back()) return std::nullopt;
  return text;
}

std::optional<std::string_view> checked_parameter(std::string_view line) {
  if (line.size() < 3 || line[line.size() - 2] != ';') return std::nullopt;
  const std::string_view text = line.substr(0, line.size() - 2);
  if (scip_sum(text) != line.back()) return std::nullopt;
  return text;
}

std::optional<std::uint32_t> scip_number(std::string_view characters) {
  if (characters.empty() || characters.size() > 5) return std::nullopt;
  std::uint32_t number = 0;
  for (const char c : characters) {
    const unsigned bits = static_cast<unsigned char>(c) - 0x30u;
    if (bits > 0x3fu) return std::nullopt;
    number = number << 6 | bits;
  }
  return number;
}

std::optional<ScipReply> parse_scip_reply(std::string_view text) {
  ScipReply reply;
  std::size_t num_lines = 0;
  for (std::size_t begin = 0; begin <= text.size(); ++num_lines) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    if (num_lines == 0) {
      reply.echo = line;
    } else if (num_lines == 1) {
      const auto status = checked_line(line);
      if (!status || status->size() != 2) return std::nullopt;
      reply.status = *status;
    } else {
      reply.body.push_back(line);
    }
    begin = end + 1;
  }
  if (reply.echo.size() < 2 || num_lines < 2) return std::nullopt;
  return reply;
}

std::optional<ScipParameters> parse_scip_parameters(const std::vector<std::string_view>& lines) {
  ScipParameters p;
  int rate_rpm = 0;
  std::map<std::string_view, int*> wanted = {
      {"DMIN:", &p.range_min_mm}, {"DMAX:", &p.range_max_mm}, {"ARES:", &p.steps_per_turn},
      {"AMIN:", &p.first_step},   {"AMAX:", &p.last_step},    {"AFRT:", &p.front_step},
      {"SCAN:", &rate_rpm}};
  for (const std::string_view line : lines) {
    const auto text = checked_parameter(line);
    if (!text || text->size() < 5) continue;
    const std::string_view name = text->substr(0, 5);
    const std::string_view value = text->substr(5);
    if (name == "MODL:") p.model = std::string(value.substr(0, 80));
    const auto key = wanted.find(name);
    if (key == wanted.end()) continue;
    const auto number = padded_number(value);
    if (!number) return std::nullopt;
    *key->second = *number;
    wanted.erase(key);
  }
  p.rate_rpm = rate_rpm;
  if (!wanted.empty() || !is_scanner(p)) return std::nullopt;
  return p;
}

std::optional<double> parse_scip_motor_rpm(const std::vector<std::string_view>& lines) {
  for (const std::string_view line : lines) {
    const auto text = checked_parameter(line);
    if (!text || text->substr(0, 5) != "SCSP:") continue;
    const std::size_t unit = text->find("[rpm]");
    if (unit == std::string_view::npos) return std::nullopt;
    std::size_t begin = unit;
    while (begin > 0 && (*text)[begin - 1] >= '0' && (*text)[begin - 1] <= '9') --begin;
    const auto rpm = padded_number(text->substr(begin, unit - begin));
    if (!rpm || *rpm < kMinRate_rpm || *rpm > kMaxRate_rpm) return std::nullopt;
    return *rpm;
  }
  return std::nullopt;
}

int characters_per_beam(ScipEncoding encoding) {
  switch (encoding) {
    case ScipEncoding::kTwo:
      return 2;
    case ScipEncoding::kThree:
      return 3;
    default:
      return 6;
  }
}

std::optional<ScipSweep> parse_scip_sweep(const std::vector<std::string_view>& lines,
                                          const ScipParameters& p, ScipEncoding encoding) {
  if (lines.empty()) return std::nullopt;
  const auto time = checked_line(lines.front());
  if (!time || time->size() != kCharacters_of_time) return std::nullopt;
  const auto ticks = scip_number(*time);
  const auto per_beam = static_cast<std::size_t>(characters_per_beam(encoding));
  const auto num_beams = static_cast<std::size_t>(p.num_beams());
  const auto data = join_checked(lines, per_beam * num_beams);
  if (!ticks || !data) return std::nullopt;

  ScipSweep sweep;
  sweep.ticks = *ticks;
  sweep.scan.bearing_min_rad = p.bearing_min_rad();
  sweep.scan.bearing_step_rad = p.step_rad();
  sweep.scan.beam_period_us = p.beam_period_us();
  sweep.scan.range_min_m = metres(p.range_min_mm);
  sweep.scan.range_max_m = metres(p.range_max_mm);
  sweep.scan.ranges_m.reserve(num_beams);
  const bool has_intensities = encoding == ScipEncoding::kThreeWithIntensity;
  const std::size_t range_size = has_intensities ? 3 : per_beam;
  for (std::size_t i = 0; i < num_beams; ++i) {
    const std::string_view beam = std::string_view(*data).substr(i * per_beam, per_beam);
    const auto range_mm = scip_number(beam.substr(0, range_size));
    if (!range_mm) return std::nullopt;
    const auto range = static_cast<std::int64_t>(*range_mm);
    const bool is_range = range >= p.range_min_mm && range <= p.range_max_mm;
    sweep.scan.ranges_m.push_back(is_range ? metres(range) : 0.0f);
    if (!has_intensities) continue;
    const auto intensity = scip_number(beam.substr(range_size));
    if (!intensity) return std::nullopt;
    sweep.scan.intensities.push_back(static_cast<float>(*intensity));
  }
  return sweep;
}

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

ScipEncoding ScipProtocol::best_encoding() const {
  return parameters_->fits_two_characters() ? ScipEncoding::kTwo
                                            : ScipEncoding::kThreeWithIntensity;
}

void ScipProtocol::begin_stream(ScipEncoding encoding, std::int64_t host_utime) {
  encoding_ = encoding;
  step_ = Step::kStream;
  num_asked_ = 0;
  is_granted_ = is_refused_ = false;
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
    std::string_view text = std::string_view(buffer_).substr(begin, end - begin);
    begin = end + 2;
    if (const std::size_t echo = last_echo(text); echo > 0) {
      units_.add_refused(host_utime, "half a sweep");
      text.remove_prefix(echo);
    }
    const auto reply = parse_scip_reply(text);
    if (reply && is_answer(reply->echo)) {
      take(*reply, host_utime);
    } else if (step_ == Step::kStream) {
      // Until then, replies may belong to an earlier connection.
      units_.add_refused(host_utime, "a reply that was not asked for");
    }
  }
  buffer_.erase(0, begin);
  bound_buffer(host_utime);
}

/// Where the last reply to the stream's command begins: a sweep whose end is missing stands before
/// it. 0 where there is none.
std::size_t ScipProtocol::last_echo(std::string_view text) const {
  if (step_ != Step::kStream) return 0;
  const std::size_t echo = text.rfind(std::string_view(command_).substr(0, command_.size() - 2));
  return echo == std::string_view::npos ? 0 : echo;
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
      if (reply.status == "01") {
        trouble_ = {Severity::kError, "the laser of the scanner does not switch on (status 01)"};
      }
      return begin_stream(best_encoding(), host_utime);
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
  units_.add_refused(host_utime, "invalid parameters");
  if (num_asked_ < kMaxAsked) return ask_again(host_utime);
  fail("the parameters of the scanner (reply to PP) are invalid");
}

void ScipProtocol::take_clock_reading(const ScipReply& reply, std::int64_t host_utime) {
  const auto time = reply.body.empty() ? std::nullopt : checked_line(reply.body.front());
  const auto ticks = time && time->size() == 4 ? scip_number(*time) : std::nullopt;
  if (ticks) {
    clock_.read_between(*ticks, asked_utime_, host_utime);
  } else {
    units_.add_refused(host_utime, "an invalid reading of the clock");
  }
  if (++num_readings_ < kNumReadings) return ask(Step::kClockRead, host_utime);
  ask(Step::kClockOut, host_utime);
}

void ScipProtocol::take_stream(const ScipReply& reply, std::int64_t host_utime) {
  if (reply.status == "99") return take_sweep(reply, host_utime);
  if (reply.status == "00") {
    grant();
    if (trouble_.severity == Severity::kWaiting) trouble_ = {};
    deadline_utime_ = host_utime + kFirstSweep_us;
    return;
  }
  refuse_stream(reply.status, host_utime);
}

void ScipProtocol::grant() {
  is_granted_ = true;
  is_refused_ = false;
  num_asked_ = 1;
}

void ScipProtocol::refuse_stream(std::string_view status, std::int64_t host_utime) {
  const bool is_unknown = status == "0D" || status == "0E";  // undefined command
  if (!is_granted_ && is_unknown && encoding_ == ScipEncoding::kThreeWithIntensity) {
    return begin_stream(ScipEncoding::kThree, host_utime);  // a model without intensities
  }
  is_refused_ = true;
  const std::string name = "status " + std::string(status);
  if (status == "98") {
    trouble_ = {Severity::kWarning,
                "the scanner reports " + name + ": it resumes after a self-test"};
  } else if (status >= "21" && status <= "97") {
    trouble_ = {Severity::kError, "the scanner reports " + name +
                                      (status < "50" ? ": it stopped because of an error"
                                                     : ": hardware fault (laser, motor)")};
  } else if (!is_granted_) {
    trouble_ = {Severity::kWaiting, "the scanner is not ready for " + command_ + ": " + name};
  } else {
    units_.add_refused(host_utime, "the scanner reports " + name);
  }
}

void ScipProtocol::take_sweep(const ScipReply& reply, std::int64_t host_utime) {
  auto sweep = parse_scip_sweep(reply.body, *parameters_, encoding_);
  if (!sweep) {
    return units_.add_refused(host_utime, "a wrong checksum or number of beams in a sweep");
  }
  grant();
  is_streaming_ = true;
  trouble_ = {};
  deadline_utime_ = host_utime + kAnswer_us +
                    static_cast<std::int64_t>(kMaxSilence_turns * parameters_->turn_us());
  const double step_0_us = clock_.arrived(sweep->ticks, host_utime);
  const double first_beam_us = parameters_->first_step * parameters_->beam_period_us();
  sweep->scan.utime = clock_.host_utime(step_0_us + first_beam_us);
  take_scan(std::move(sweep->scan), host_utime);
}

/// A scanner that is getting ready refuses for some seconds what it grants later.
void ScipProtocol::ask_for_stream_again(std::int64_t host_utime) {
  constexpr int kMaxRefused = kFirstSweep_us / kAnswer_us;
  if (num_asked_ < (is_refused_ ? kMaxRefused : kMaxAsked)) return ask_again(host_utime);
  if (encoding_ == ScipEncoding::kThreeWithIntensity) {
    return begin_stream(ScipEncoding::kThree, host_utime);
  }
  fail(no_answer());
}

std::string ScipProtocol::no_answer() const {
  if (!trouble_.text.empty()) return trouble_.text;
  return "no answer to " + command_ + "; check that it is a scanner with SCIP 2.0";
}

void ScipProtocol::expire(std::int64_t host_utime) {
  switch (step_) {
    case Step::kState:
      return ask(Step::kClockIn, host_utime);  // can do without
    case Step::kClockIn:
      return ask(Step::kLaser, host_utime);  // can do without
    case Step::kLaser:
      return begin_stream(best_encoding(), host_utime);
    case Step::kStream:
      if (!is_granted_) return ask_for_stream_again(host_utime);
      if (may_restart()) ask(Step::kStop, host_utime);
      return;
    default:
      break;
  }
  if (num_asked_ >= kMaxAsked) return fail(no_answer());
  // A URG-04LX starts in SCIP 1.1; other models answer the switch with an error, which is ignored.
  // The empty line ends a command that a broken connection may have left incomplete.
  if (step_ == Step::kStop) to_send_ += "\nSCIP2.0\n";
  ask_again(host_utime);
}

}  // namespace orchard::device
