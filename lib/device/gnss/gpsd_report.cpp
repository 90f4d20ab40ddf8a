// SPDX-License-Identifier: BSD-3-Clause
#include "device/gnss/gpsd_report.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace orchard::device {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxReceivers = 32;

/// Reads the fields of a report and keeps the first error.
class Fields {
 public:
  explicit Fields(const Json& report) : report_(report) {}

  std::optional<double> number(const char* key, double lo, double hi) {
    const Json* field = find(key);
    if (field == nullptr) return std::nullopt;
    if (!field->is_number()) return object(key, "is not a number");
    const double value = field->get<double>();
    if (!(value >= lo && value <= hi)) return object(key, "is out of range");
    return value;
  }

  int whole(const char* key, int hi) {
    const Json* field = find(key);
    if (field == nullptr) return 0;
    if (!field->is_number_integer() || *field < 0 || *field > hi) {
      object(key, "is not one of its values");
      return 0;
    }
    return field->get<int>();
  }

  std::string text(const char* key) {
    const Json* field = find(key);
    if (field == nullptr) return {};
    if (field->is_string()) return field->get<std::string>();
    object(key, "is not a text");
    return {};
  }

  std::optional<std::int64_t> time(const char* key) {
    if (find(key) == nullptr) return std::nullopt;
    const std::optional<std::int64_t> utime = parse_utc(text(key));
    if (!utime) object(key, "is not a time");
    return utime;
  }

  const std::string& why() const { return why_; }

 private:
  const Json* find(const char* key) const {
    const auto found = report_.find(key);
    return found == report_.end() || found->is_null() ? nullptr : &*found;
  }

  std::nullopt_t object(const char* key, const char* what) {
    if (why_.empty()) why_ = std::string(key) + " " + what;
    return std::nullopt;
  }

  const Json& report_;
  std::string why_;
};

GpsdFix read_fix(Fields& fields) {
  GpsdFix fix;
  fix.device = fields.text("device");
  fix.mode = fields.whole("mode", 3);
  fix.status = fields.whole("status", 9);
  fix.time_us = fields.time("time");
  fix.latitude_deg = fields.number("lat", -90.0, 90.0);
  fix.longitude_deg = fields.number("lon", -180.0, 180.0);
  fix.altitude_m = fields.number("altHAE", -12000.0, 100000.0);
  fix.eph_m = fields.number("eph", 0.0, 1e7);
  fix.epx_m = fields.number("epx", 0.0, 1e7);
  fix.epy_m = fields.number("epy", 0.0, 1e7);
  fix.epv_m = fields.number("epv", 0.0, 1e7);
  return fix;
}

GpsdNoise read_noise(Fields& fields) {
  GpsdNoise noise;
  noise.device = fields.text("device");
  noise.time_us = fields.time("time");
  noise.north_sd_m = fields.number("lat", 0.0, 1e7);
  noise.east_sd_m = fields.number("lon", 0.0, 1e7);
  noise.up_sd_m = fields.number("alt", 0.0, 1e7);
  noise.major_sd_m = fields.number("major", 0.0, 1e7);
  noise.minor_sd_m = fields.number("minor", 0.0, 1e7);
  noise.orientation_deg = fields.number("orient", -360.0, 360.0);
  return noise;
}

GpsdDevices read_devices(const Json& report) {
  GpsdDevices devices;
  const auto list = report.find("devices");
  if (list == report.end() || !list->is_array()) return devices;
  for (const Json& device : *list) {
    if (!device.is_object() || devices.paths.size() == kMaxReceivers) continue;
    const auto path = device.find("path");
    if (path != device.end() && path->is_string())
      devices.paths.push_back(path->get<std::string>());
  }
  return devices;
}

/// Days from 1970-01-01 in the Gregorian calendar, counted in years that begin in March.
std::int64_t days_since_1970(int year, int month, int day) {
  const int march_year = month > 2 ? year : year - 1;
  const int march_month = (month + 9) % 12;
  const std::int64_t leap_days = march_year / 4 - march_year / 100 + march_year / 400;
  return 365LL * march_year + leap_days + (153 * march_month + 2) / 5 + day - 1 - 719468;
}

std::optional<int> digits(std::string_view text, std::size_t at, std::size_t count, int lo,
                          int hi) {
  if (at + count > text.size()) return std::nullopt;
  const std::string_view word = text.substr(at, count);
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  if (!std::all_of(word.begin(), word.end(), is_digit)) return std::nullopt;
  int value = 0;
  std::from_chars(word.data(), word.data() + word.size(), value);
  return value >= lo && value <= hi ? std::optional<int>(value) : std::nullopt;
}

}  // namespace

std::optional<std::int64_t> parse_utc(std::string_view text) {
  constexpr std::string_view kForm = "....-..-..T..:..:..";
  if (text.size() <= kForm.size() || text.back() != 'Z') return std::nullopt;
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    if (kForm[i] != '.' && kForm[i] != text[i]) return std::nullopt;
  }
  const auto year = digits(text, 0, 4, 1970, 2200), month = digits(text, 5, 2, 1, 12);
  const auto day = digits(text, 8, 2, 1, 31), hour = digits(text, 11, 2, 0, 23);
  const auto minute = digits(text, 14, 2, 0, 59), second = digits(text, 17, 2, 0, 60);
  if (!year || !month || !day || !hour || !minute || !second) return std::nullopt;
  std::string fraction(text.substr(kForm.size(), text.size() - kForm.size() - 1));
  int micros = 0;
  if (!fraction.empty()) {
    if (fraction[0] != '.' || fraction.size() > 10) return std::nullopt;
    fraction.resize(7, '0');  // digits below a microsecond are cut off
    const auto value = digits(fraction, 1, 6, 0, 999999);
    if (!value) return std::nullopt;
    micros = *value;
  }
  const std::int64_t seconds =
      ((days_since_1970(*year, *month, *day) * 24 + *hour) * 60 + *minute) * 60 + *second;
  return seconds * 1'000'000 + micros;
}

GpsdReport parse_gpsd_report(std::string_view line) {
  const Json report = Json::parse(line.begin(), line.end(), nullptr, false);
  if (!report.is_object()) return GpsdBad{"not a JSON object"};
  Fields fields(report);
  const std::string name = fields.text("class");
  GpsdReport read;
  if (name == "TPV") {
    read = read_fix(fields);
  } else if (name == "GST") {
    read = read_noise(fields);
  } else if (name == "DEVICES") {
    read = read_devices(report);
  } else if (name == "ERROR") {
    read = GpsdError{fields.text("message")};
  } else if (name.empty()) {
    return GpsdBad{"a report without a class"};
  }
  if (!fields.why().empty()) return GpsdBad{name + ": " + fields.why()};
  return read;
}

}  // namespace orchard::device
