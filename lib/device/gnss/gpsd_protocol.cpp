// SPDX-License-Identifier: BSD-3-Clause
#include "device/gnss/gpsd_protocol.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "text/number_text.hpp"

namespace orchard::device {
namespace {

enum Quality : std::int8_t {
  kNoFix = 0,
  kSingle = 1,
  kDifferential = 2,
  kMilitary = 3,
  kRtkFixed = 4,
  kRtkFloat = 5,
  kEstimated = 6,
  kSurveyed = 7,
  kSimulated = 8,
};

constexpr double kMaxOfRtk_m = 1.0;  // above, eph is not the error of the RTK solution

bool is_rtk(std::int8_t quality) { return quality == kRtkFixed || quality == kRtkFloat; }

/// Covariance from the error ellipse, else from the standard deviations; false without both.
bool from_noise(const GpsdNoise& noise, std::array<double, 6>& covariance) {
  auto& [ee, en, eu, nn, nu, uu] = covariance;
  if (noise.major_sd_m && noise.minor_sd_m && noise.orientation_deg && *noise.major_sd_m > 0.0) {
    const double angle_rad = *noise.orientation_deg * geometry::kPi / 180.0;
    const double sine = std::sin(angle_rad), cosine = std::cos(angle_rad);
    const double major = geometry::square(*noise.major_sd_m),
                 minor = geometry::square(*noise.minor_sd_m);
    ee = major * sine * sine + minor * cosine * cosine;
    nn = major * cosine * cosine + minor * sine * sine;
    en = (major - minor) * sine * cosine;
  } else if (noise.north_sd_m && noise.east_sd_m && *noise.north_sd_m > 0.0 &&
             *noise.east_sd_m > 0.0) {
    ee = geometry::square(*noise.east_sd_m);
    nn = geometry::square(*noise.north_sd_m);
  } else {
    return false;
  }
  uu = noise.up_sd_m && *noise.up_sd_m > 0.0 ? geometry::square(*noise.up_sd_m)
                                             : pose::kUnknownAltitudeVariance_m2;
  return true;
}

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

constexpr std::size_t kLongestLine_bytes = 32768;  // SKY of a receiver of four systems: about 15 kB
constexpr std::int64_t kSilence_us = 2'000'000;
constexpr int kMaxUnanswered = 5;
constexpr std::int64_t kNoiseAge_us = 1'500'000;
constexpr double kImplausibleLead_s = 2.0;
constexpr std::size_t kShownBytes = 60;

/// A JSON string literal: quotes and backslashes escaped.
std::string json_quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char byte : text) {
    if (byte == '"' || byte == '\\') quoted += '\\';
    if (byte >= ' ') quoted += byte;
  }
  return quoted + '"';
}

}  // namespace

std::int8_t gga_quality(const GpsdFix& fix) {
  if (fix.mode < 2) return kNoFix;
  // gpsd_json(5), TPV, status. An absent status means a plain fix.
  constexpr std::array<std::int8_t, 10> kByStatus{kSingle,    kSingle,    kDifferential, kRtkFixed,
                                                  kRtkFloat,  kEstimated, kEstimated,    kSurveyed,
                                                  kSimulated, kMilitary};
  return kByStatus[static_cast<std::size_t>(fix.status)];
}

std::array<double, 6> enu_covariance(const GpsdFix& fix, const GpsdNoise* noise) {
  std::array<double, 6> covariance{};
  if (noise != nullptr && from_noise(*noise, covariance)) return covariance;
  double east_sd_m = 0.0, north_sd_m = 0.0;
  if (fix.eph_m && *fix.eph_m > 0.0) {
    east_sd_m = north_sd_m = *fix.eph_m;
  } else if (fix.epx_m && fix.epy_m && *fix.epx_m > 0.0 && *fix.epy_m > 0.0) {
    east_sd_m = *fix.epx_m;
    north_sd_m = *fix.epy_m;
  } else {
    return covariance;
  }
  if (is_rtk(gga_quality(fix)) && std::max(east_sd_m, north_sd_m) > kMaxOfRtk_m) return covariance;
  covariance[0] = geometry::square(east_sd_m);
  covariance[3] = geometry::square(north_sd_m);
  covariance[5] = fix.mode == 3 && fix.epv_m && *fix.epv_m > 0.0
                      ? geometry::square(*fix.epv_m)
                      : pose::kUnknownAltitudeVariance_m2;
  return covariance;
}

std::optional<pose::Gnss> to_measurement(const GpsdFix& fix, const GpsdNoise* noise) {
  if (fix.mode < 2 || !fix.latitude_deg || !fix.longitude_deg) return std::nullopt;
  pose::Gnss gnss;
  gnss.latitude_deg = *fix.latitude_deg;
  gnss.longitude_deg = *fix.longitude_deg;
  gnss.altitude_m = fix.altitude_m.value_or(0.0);
  gnss.covariance = enu_covariance(fix, noise);
  if (!fix.altitude_m && gnss.covariance[0] > 0.0)
    gnss.covariance[5] = pose::kUnknownAltitudeVariance_m2;
  gnss.fix_quality = gga_quality(fix);
  return gnss;
}

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

GpsdProtocol::GpsdProtocol(const GnssDriverConfig& config)
    : config_(config), lines_(kLongestLine_bytes), clock_(32, 1.0), receiver_(config.receiver) {
  clock_.set_min_delay(1e6 * config.latency_s);
}

void GpsdProtocol::connected(std::int64_t host_utime) {
  lines_.restart(false);
  clock_.begin_connection();
  noise_.reset();
  incomplete_.reset();
  has_receivers_.reset();
  error_.clear();
  no_fix_ = {};
  num_unanswered_ = 0;
  fix_utime_ = 0;
  deadline_ = host_utime + kSilence_us;
  // gpsd_json(5): ?WATCH. With "device" gpsd sends the reports of that receiver only.
  to_send_ = "?WATCH={\"enable\":true,\"json\":true" +
             (config_.receiver.empty() ? "" : ",\"device\":" + json_quoted(config_.receiver)) +
             "};\n";
}

void GpsdProtocol::receive(std::string_view bytes, std::int64_t host_utime) {
  lines_.add(bytes, [&](std::string_view line) { take_line(line, host_utime); });
}

void GpsdProtocol::expire(std::int64_t host_utime) {
  // gpsd says nothing when a receiver is unplugged: request the list of devices.
  to_send_ += "?DEVICES;\n";
  ++num_unanswered_;
  deadline_ = host_utime + kSilence_us;
  if (host_utime - fix_utime_ < kSilence_us) return;
  fix_utime_ = 0;
  no_fix_ = {Severity::kError, "gpsd sends no fixes; check that the receiver is still plugged in"};
}

void GpsdProtocol::host_clock_stepped(std::int64_t step_us) {
  clock_.host_stepped(step_us);
  units_.host_clock_stepped();
  last_utime_ += step_us;
  if (incomplete_) incomplete_->utime += step_us;
  if (fix_utime_ != 0) fix_utime_ += step_us;
  if (deadline_) *deadline_ += step_us;
}

std::string GpsdProtocol::failure() const {
  return num_unanswered_ > kMaxUnanswered ? "gpsd does not answer any more" : "";
}

Condition GpsdProtocol::condition() const {
  Condition condition;
  if (!error_.empty()) condition.add(Severity::kError, "gpsd reports: " + error_);
  if (fix_utime_ == 0) {
    condition.add(why_no_fix().severity, why_no_fix().text);
  } else if (std::abs(fix_lead_s_) > kImplausibleLead_s) {
    condition.add(Severity::kWarning,
                  "fixes arrive " + fixed_text(fix_lead_s_, 1) +
                      " s after their own time stamp: the clock of this machine is not "
                      "synchronised to satellite time; use drivers.gnss.stamp: receipt");
  }
  if (fix_utime_ != 0 && num_other_receivers_ > 0) {
    condition.add(Severity::kWarning, "reads " + shown_text(receiver_, kShownBytes) +
                                          " only, but gpsd has several receivers; choose one with "
                                          "drivers.gnss.receiver");
  }
  condition.add(Severity::kWarning, units_.warning("reports"));
  return condition;
}

Condition GpsdProtocol::why_no_fix() const {
  if (has_receivers_ == false) {
    return {Severity::kError,
            "gpsd has no receiver; check that it is plugged in and that gpsd was started with its "
            "device"};
  }
  if (!no_fix_.text.empty()) return no_fix_;
  return {Severity::kWaiting,
          "waits for the first report" +
              (receiver_.empty() ? "" : " of " + shown_text(receiver_, kShownBytes))};
}

ProtocolCounts GpsdProtocol::counts() const {
  ProtocolCounts counts = units_.counts();
  counts.num_bad += lines_.num_too_long();
  return counts;
}

void GpsdProtocol::take_line(std::string_view line, std::int64_t host_utime) {
  const GpsdReport report = parse_gpsd_report(line);
  if (const auto* bad = std::get_if<GpsdBad>(&report)) {
    return units_.add_refused(host_utime, shown_text(bad->why, kShownBytes));
  }
  units_.add_good(host_utime);
  num_unanswered_ = 0;
  if (const auto* devices = std::get_if<GpsdDevices>(&report)) {
    has_receivers_ = !devices->paths.empty();
  } else if (const auto* error = std::get_if<GpsdError>(&report)) {
    error_ = shown_text(error->message, kShownBytes);
  } else if (const auto* noise = std::get_if<GpsdNoise>(&report)) {
    if (!is_ours(noise->device)) return;
    noise_ = *noise;
    noise_status_ = last_status_;
  } else if (const auto* fix = std::get_if<GpsdFix>(&report)) {
    if (is_ours(fix->device)) take_fix(*fix, host_utime);
  }
}

bool GpsdProtocol::is_ours(const std::string& device) {
  if (receiver_.empty()) receiver_ = device;
  if (device == receiver_) return true;
  ++num_other_receivers_;
  return false;
}

void GpsdProtocol::take_fix(const GpsdFix& fix, std::int64_t host_utime) {
  has_receivers_ = true;
  deadline_ = host_utime + kSilence_us;
  std::optional<pose::Gnss> gnss = to_measurement(fix, noise_of(fix));
  last_status_ = fix.status;
  if (!gnss || !fix.time_us) {
    // Before the first fix it searches; later it has lost what the drive may need.
    no_fix_ = last_fix_time_us_ ? Condition{Severity::kWarning, "the receiver has lost its fix"}
                                : Condition{Severity::kWaiting, "the receiver has no fix yet"};
    if (gnss) no_fix_ = {Severity::kWarning, "the receiver's fixes have no time"};
    incomplete_.reset();
    fix_utime_ = 0;
    return;
  }
  fix_utime_ = host_utime;
  error_.clear();
  // gpsd repeats a fix whenever more of its fields are known: after each NMEA sentence.
  const bool is_new = last_fix_time_us_ != fix.time_us;
  if (is_new && incomplete_) {
    has_status_ = false;
    publish(*std::exchange(incomplete_, std::nullopt));
  }
  if (!is_new && !incomplete_) {
    has_status_ = has_status_ || fix.status != 0;
    return;
  }
  gnss->utime = is_new ? stamp(*fix.time_us, host_utime) : incomplete_->utime;
  last_fix_time_us_ = fix.time_us;
  has_status_ = has_status_ || fix.status != 0;
  const bool is_complete = (fix.mode < 3 || fix.altitude_m) && (fix.status != 0 || !has_status_);
  incomplete_ = *gnss;
  if (is_complete) publish(*std::exchange(incomplete_, std::nullopt));
}

void GpsdProtocol::publish(pose::Gnss gnss) {
  if (gnss.utime <= last_utime_) gnss.utime = last_utime_ + 1;
  last_utime_ = gnss.utime;
  measurements_.emplace_back(gnss);
}

std::int64_t GpsdProtocol::stamp(std::int64_t fix_time_us, std::int64_t host_utime) {
  if (config_.stamp == GnssStamp::kFixTime) {
    fix_lead_s_ = 1e-6 * static_cast<double>(host_utime - fix_time_us);
    return fix_time_us;
  }
  return clock_.host_utime(clock_.arrived(static_cast<std::uint32_t>(fix_time_us), host_utime));
}

const GpsdNoise* GpsdProtocol::noise_of(const GpsdFix& fix) const {
  if (!noise_ || !noise_->time_us || !fix.time_us) return nullptr;
  if (*noise_->time_us == *fix.time_us) return &*noise_;
  // The noise of the fix before applies while the status is the same.
  const std::int64_t age_us = *fix.time_us - *noise_->time_us;
  const bool is_near = age_us > 0 && age_us <= kNoiseAge_us;
  return is_near && noise_status_ == fix.status ? &*noise_ : nullptr;
}

}  // namespace orchard::device
