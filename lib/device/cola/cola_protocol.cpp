// SPDX-License-Identifier: BSD-3-Clause
#include "device/cola/cola_protocol.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::device {
namespace {

constexpr std::int32_t kUnits_per_degree = 10'000;
constexpr std::int32_t kUnits_per_turn = 360 * kUnits_per_degree;
constexpr std::int32_t kAhead = 90 * kUnits_per_degree;

constexpr std::uint32_t kMaxBeams = 10'000;
constexpr std::uint32_t kMaxChannels = 16;
constexpr std::uint32_t kMaxEncoders = 8;

/// Max time from measurement to transmission; a longer one means invalid time stamps.
constexpr std::uint32_t kMaxDelay_us = 10'000'000;

/// Bits of the second field of the device status.
constexpr std::uint32_t kDeviceError = 1;
constexpr std::uint32_t kPollution = 2 | 4;

double radians(double units) { return units / kUnits_per_degree * geometry::kPi / 180.0; }

/// One channel of values: distances, intensities.
struct Channel {
  std::string_view content;
  double scale = 1.0;
  double offset = 0.0;
  std::int32_t start = 0;
  std::uint32_t step = 0;
  std::vector<std::uint32_t> values;
};

std::vector<Channel> read_channels(ColaFields& fields, std::uint32_t max_value) {
  std::vector<Channel> channels(fields.number(kMaxChannels));
  for (Channel& channel : channels) {
    channel.content = fields.text();
    channel.scale = static_cast<double>(fields.real());
    channel.offset = static_cast<double>(fields.real());
    channel.start = fields.signed_number();
    channel.step = fields.number(0xffff);
    const std::uint32_t num_values = fields.number(kMaxBeams);
    if (!fields.ok()) return {};
    channel.values.reserve(num_values);
    for (std::uint32_t i = 0; i < num_values && fields.ok(); ++i) {
      channel.values.push_back(fields.number(max_value));
    }
  }
  return channels;
}

const Channel* find(const std::vector<Channel>& channels, std::string_view content) {
  for (const Channel& channel : channels) {
    if (channel.content == content) return &channel;
  }
  return nullptr;
}

bool is_sound(const Channel& c) {
  const auto num_steps = static_cast<std::int64_t>(c.values.size()) - 1;
  return num_steps >= 1 && c.step > 0 && num_steps * c.step <= kUnits_per_turn &&
         std::abs(c.start) <= kUnits_per_turn && std::isfinite(c.scale) && c.scale > 0.0 &&
         c.scale <= 100.0 && std::isfinite(c.offset) && std::abs(c.offset) <= 1e6;
}

/// The step between beams [1/10000 degree], free of rounding where the ends are known.
double exact_step(const Channel& c, const std::optional<ColaRange>& range) {
  const auto rounded = static_cast<double>(c.step);
  if (!range || range->start != c.start) return rounded;
  const double step =
      static_cast<double>(range->stop - range->start) / static_cast<double>(c.values.size() - 1);
  return std::abs(step - rounded) < 1.0 ? step : rounded;
}

float metres(double value_mm, const ColaModel& model) {
  const double range_m = 1e-3 * value_mm;
  // Values below range_min_m are codes: 0 for no return, others for dazzle and the like.
  const bool is_range = range_m >= model.range_min_m && range_m <= model.range_max_m;
  return is_range ? static_cast<float>(range_m) : 0.0f;
}

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

std::string_view ColaFields::text() {
  if (!ok_ || rest_.empty()) {
    ok_ = false;
    return {};
  }
  const std::size_t end = rest_.find(' ');
  const std::string_view field = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
  if (field.empty()) ok_ = false;
  return field;
}

std::uint32_t ColaFields::number(std::uint32_t max) {
  const std::string_view field = text();
  std::uint32_t number = 0;
  const auto end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, number, 16);
  if (!ok_ || field.size() > 8 || result.ec != std::errc() || result.ptr != end || number > max) {
    ok_ = false;
    return 0;
  }
  return number;
}

std::int32_t ColaFields::signed_number() {
  const std::string_view next = rest_.substr(0, 1);
  if (next != "+" && next != "-") {
    const std::uint32_t bits = number();
    std::int32_t value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  std::string_view field = text();
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  std::int32_t value = 0;
  const auto end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, value);
  if (!ok_ || field.empty() || result.ec != std::errc() || result.ptr != end) {
    ok_ = false;
    return 0;
  }
  return value;
}

float ColaFields::real() {
  const std::uint32_t bits = number();
  float value = 0.0f;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

void ColaFields::skip(int num_fields) {
  for (int i = 0; i < num_fields; ++i) text();
}

ColaModel cola_model(std::string_view name) {
  // Working ranges from the manufacturer's data sheets.
  static constexpr std::array<std::pair<std::string_view, ColaModel>, 9> kModels = {{
      {"TiM31", {0.05, 4.0, -450000}},
      {"TiM32", {0.05, 4.0, -450000}},
      {"TiM35", {0.05, 10.0, -450000}},
      {"TiM55", {0.05, 10.0, -450000}},
      {"TiM56", {0.05, 10.0, -450000}},
      {"TiM57", {0.05, 25.0, -450000}},
      {"LMS10", {0.01, 20.0, -450000}},
      {"LMS11", {0.01, 20.0, -450000}},
      {"LMS15", {0.01, 50.0, -450000}},
  }};
  for (const auto& [prefix, model] : kModels) {
    if (name.substr(0, prefix.size()) == prefix) return model;
  }
  return {};
}

std::optional<ColaRange> parse_cola_range(std::string_view telegram) {
  ColaFields fields(telegram);
  if (fields.text() != "sRA" || fields.text() != "LMPoutputRange") return std::nullopt;
  fields.skip(1);         // number of sectors, always 1
  fields.number(0xffff);  // angular step
  ColaRange range;
  range.start = fields.signed_number();
  range.stop = fields.signed_number();
  const bool is_range = fields.ok() && std::abs(range.start) <= kUnits_per_turn &&
                        std::abs(range.stop) <= kUnits_per_turn && range.stop > range.start;
  return is_range ? std::optional(range) : std::nullopt;
}

std::optional<ColaScan> parse_cola_scan(std::string_view telegram, const ColaModel& model,
                                        const std::optional<ColaRange>& range) {
  ColaFields fields(telegram);
  const std::string_view kind = fields.text();
  if ((kind != "sSN" && kind != "sRA") || fields.text() != "LMDscandata") return std::nullopt;
  ColaScan sweep;
  fields.skip(3);  // version, number and serial number of the device
  fields.number(0xff);
  const std::uint32_t state = fields.number(0xff);
  sweep.has_error = (state & kDeviceError) != 0;
  sweep.is_dirty = (state & kPollution) != 0;
  sweep.num_sent = fields.number(0xffff);
  fields.skip(1);  // sweeps counted
  sweep.start_ticks = fields.number();
  sweep.sent_ticks = fields.number();
  fields.skip(5);  // digital inputs and outputs, layer
  const double rate_hz = 0.01 * fields.number();
  fields.skip(1);  // frequency of single measurements
  const std::uint32_t num_encoders = fields.number(kMaxEncoders);
  for (std::uint32_t i = 0; i < num_encoders; ++i) fields.skip(2);
  const std::vector<Channel> wide = read_channels(fields, 0xffff);
  const std::vector<Channel> narrow = read_channels(fields, 0xff);
  const Channel* ranges = find(wide, "DIST1");
  if (!fields.ok() || ranges == nullptr || !is_sound(*ranges) || rate_hz < 1.0 ||
      rate_hz > 1000.0 || sweep.sent_ticks - sweep.start_ticks > kMaxDelay_us) {
    return std::nullopt;
  }

  laser::Scan& scan = sweep.scan;
  const double step = exact_step(*ranges, range);
  const double unit_us = 1e6 / rate_hz / kUnits_per_turn;
  scan.bearing_min_rad = radians(ranges->start - kAhead);
  scan.bearing_step_rad = radians(step);
  scan.beam_period_us = step * unit_us;
  sweep.to_first_beam_us = std::max(0, ranges->start - model.stamped_angle) * unit_us;
  scan.range_min_m = model.range_min_m;
  scan.range_max_m = model.range_max_m;
  scan.ranges_m.reserve(ranges->values.size());
  for (const std::uint32_t value : ranges->values) {
    scan.ranges_m.push_back(
        metres(value == 0 ? 0.0 : value * ranges->scale + ranges->offset, model));
  }
  const Channel* intensities = find(wide, "RSSI1");
  if (intensities == nullptr) intensities = find(narrow, "RSSI1");
  if (intensities != nullptr && intensities->values.size() == ranges->values.size() &&
      is_sound(*intensities)) {
    for (const std::uint32_t value : intensities->values) {
      scan.intensities.push_back(
          static_cast<float>(value * intensities->scale + intensities->offset));
    }
  }
  return sweep;
}

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
