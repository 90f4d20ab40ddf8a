// SPDX-License-Identifier: BSD-3-Clause
#include "device/cola/cola_scan.hpp"

#include <algorithm>
#include <array>
#include <cmath>
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

/// Length of the name of a channel: "DIST1".
constexpr std::size_t kNameLength = 5;

/// The channels of values of `value_bytes` each.
std::vector<Channel> read_channels(ColaFields& fields, int value_bytes) {
  std::vector<Channel> channels(fields.number(2, kMaxChannels));
  for (Channel& channel : channels) {
    channel.content = fields.text(kNameLength);
    channel.scale = static_cast<double>(fields.real());
    channel.offset = static_cast<double>(fields.real());
    channel.start = fields.signed_number();
    channel.step = fields.number(2);
    const std::uint32_t num_values = fields.number(2, kMaxBeams);
    if (!fields.ok()) return {};
    channel.values.reserve(num_values);
    for (std::uint32_t i = 0; i < num_values && fields.ok(); ++i) {
      channel.values.push_back(fields.number(value_bytes));
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

/// The step between beams [1/10000 degree]. The field is a whole number; where the device's range
/// of angles has the same first beam and a step within that rounding, its ends tell the step
/// exactly.
double exact_step(const Channel& c, const std::optional<ColaRange>& range) {
  const auto rounded = static_cast<double>(c.step);
  if (!range || 2.0 * std::abs(range->start - c.start) >= rounded) return rounded;
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

}  // namespace

ColaModel cola_model(std::string_view name) {
  // Working ranges from the manufacturer's data sheets.
  static constexpr std::array<std::pair<std::string_view, ColaModel>, 11> kModels = {{
      {"TiM31", {0.05, 4.0, -450000}},
      {"TiM32", {0.05, 4.0, -450000}},
      {"TiM35", {0.05, 10.0, -450000}},
      {"TiM55", {0.05, 10.0, -450000}},
      {"TiM56", {0.05, 10.0, -450000}},
      {"TiM57", {0.05, 25.0, -450000}},
      {"TiM7", {0.05, 25.0, -450000}},
      {"LMS10", {0.01, 20.0, -450000}},
      {"LMS11", {0.01, 20.0, -450000}},
      {"LMS15", {0.01, 50.0, -450000}},
      {"LMS5", {0.2, 80.0, -50000}},
  }};
  for (const auto& [prefix, model] : kModels) {
    if (name.substr(0, prefix.size()) == prefix) return model;
  }
  return {};
}

std::string_view parse_cola_name(ColaFields fields) {
  const std::uint32_t length = fields.number(2);
  return fields.text(length);
}

std::optional<ColaRange> parse_cola_range(ColaFields fields) {
  fields.skip(1, 2);  // number of sectors, always 1
  fields.number(4);   // angular step
  ColaRange range;
  range.start = fields.signed_number();
  range.stop = fields.signed_number();
  const bool is_range = fields.ok() && std::abs(range.start) <= kUnits_per_turn &&
                        std::abs(range.stop) <= kUnits_per_turn && range.stop > range.start;
  return is_range ? std::optional(range) : std::nullopt;
}

std::optional<ColaScan> parse_cola_scan(ColaFields fields, const ColaModel& model,
                                        const std::optional<ColaRange>& range) {
  ColaScan sweep;
  fields.skip(2, 2);  // version, number of the device
  fields.skip(1, 4);  // its serial number
  fields.number(1);
  const std::uint32_t state = fields.number(1);
  sweep.has_error = (state & kDeviceError) != 0;
  sweep.is_dirty = (state & kPollution) != 0;
  sweep.num_sent = fields.number(2);
  fields.skip(1, 2);  // sweeps counted
  sweep.start_ticks = fields.number(4);
  sweep.sent_ticks = fields.number(4);
  fields.skip(4, 1);  // digital inputs and outputs
  fields.skip(1, 2);  // layer
  const double rate_hz = 0.01 * fields.number(4);
  fields.skip(1, 4);  // frequency of single measurements
  const std::uint32_t num_encoders = fields.number(2, kMaxEncoders);
  for (std::uint32_t i = 0; i < num_encoders; ++i) {
    fields.skip(1, 4);  // position
    fields.skip(1, 2);  // speed
  }
  const std::vector<Channel> wide = read_channels(fields, 2);
  const std::vector<Channel> narrow = read_channels(fields, 1);
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
  sweep.to_first_beam_us = std::max(0, ranges->start - model.start_angle) * unit_us;
  sweep.to_last_beam_us = scan.beam_period_us * static_cast<double>(ranges->values.size() - 1);
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

}  // namespace orchard::device
