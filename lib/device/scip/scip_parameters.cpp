// SPDX-License-Identifier: BSD-3-Clause
#include "device/scip/scip_parameters.hpp"

#include <charconv>
#include <map>

#include "device/scip/scip_text.hpp"

namespace orchard::device {
namespace {

/// Steps are sent as four digits.
constexpr int kMaxStep = 9999;
constexpr int kMinSteps_per_turn = 16;

/// The largest number in three characters.
constexpr int kMaxRange_mm = (1 << 18) - 1;

constexpr int kMinRate_rpm = 60;
constexpr int kMaxRate_rpm = 60000;

std::optional<int> whole_number(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  int number = 0;
  const auto end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, number);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return number;
}

bool is_scanner(const ScipParameters& p) {
  return p.range_min_mm >= 0 && p.range_min_mm < p.range_max_mm && p.range_max_mm <= kMaxRange_mm &&
         p.steps_per_turn >= kMinSteps_per_turn && p.steps_per_turn <= kMaxStep + 1 &&
         p.first_step >= 0 && p.last_step > p.first_step && p.last_step <= kMaxStep &&
         p.num_beams() <= p.steps_per_turn && p.front_step >= 0 && p.front_step <= kMaxStep &&
         p.rate_rpm >= kMinRate_rpm && p.rate_rpm <= kMaxRate_rpm;
}

}  // namespace

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
    const auto number = whole_number(value);
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
    const auto rpm = whole_number(text->substr(begin, unit - begin));
    if (!rpm || *rpm < kMinRate_rpm || *rpm > kMaxRate_rpm) return std::nullopt;
    return *rpm;
  }
  return std::nullopt;
}

}  // namespace orchard::device
