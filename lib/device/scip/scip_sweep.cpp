// SPDX-License-Identifier: BSD-3-Clause
#include "device/scip/scip_sweep.hpp"

#include <string>

#include "device/scip/scip_text.hpp"

namespace orchard::device {
namespace {

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

}  // namespace

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

}  // namespace orchard::device
