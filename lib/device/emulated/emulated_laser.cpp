// SPDX-License-Identifier: BSD-3-Clause
#include "device/emulated/emulated_laser.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/angles.hpp"

namespace orchard::device {
namespace {

constexpr double kUnits_per_rad = 10'000.0 * 180.0 / geometry::kPi;
constexpr std::int32_t kAhead = 900'000;
constexpr std::int32_t kFirstShot = -450'000;
constexpr std::size_t kMaxTelegram = 256;
constexpr std::size_t kBinaryHead = 8;  ///< four STX and the length

std::int32_t start_angle(const laser::Scan& scan) {
  return static_cast<std::int32_t>(std::lround(scan.bearing_min_rad * kUnits_per_rad)) + kAhead;
}

constexpr double kTick_us = 1000.0;
constexpr std::uint64_t kClock_mask = 0xffffff;

constexpr std::size_t kMaxCommand = 64;

std::string with_sum(const std::string& text) {
  int sum = 0;
  for (const char c : text) sum += c;
  return text + static_cast<char>(sum % 64 + '0');
}

std::string encoded(std::uint64_t number, int num_characters) {
  std::string text;
  for (int i = num_characters - 1; i >= 0; --i) {
    text += static_cast<char>('0' + (number >> (6 * i)) % 64);
  }
  return text;
}

std::string parameter(const std::string& text) {
  const std::string summed = with_sum(text);
  return text + ";" + summed.back() + "\n";
}

/// The beam of the scan in the direction of a step, in units of the protocol; `none` where there is
/// no beam.
struct Beam {
  std::uint32_t range_mm = 0;
  std::uint32_t intensity = 0;
};

Beam beam_at(const laser::Scan& scan, double bearing_rad, const ScipModel& model) {
  Beam beam{model.no_return, 0};
  const double place = (bearing_rad - scan.bearing_min_rad) / scan.bearing_step_rad;
  const auto i = static_cast<std::int64_t>(std::llround(place));
  if (i < 0 || i >= static_cast<std::int64_t>(scan.ranges_m.size())) return beam;
  const auto index = static_cast<std::size_t>(i);
  const double range_mm = 1e3 * static_cast<double>(scan.ranges_m[index]);
  if (range_mm >= model.range_min_mm && range_mm <= model.range_max_mm) {
    beam.range_mm = static_cast<std::uint32_t>(std::llround(range_mm));
  }
  if (scan.has_intensities()) {
    const double intensity = std::clamp(static_cast<double>(scan.intensities[index]), 0.0, 2e5);
    beam.intensity = static_cast<std::uint32_t>(intensity);
  }
  return beam;
}

/// Clock skew: the difference between two good crystals.
constexpr double kSkew = 40e-6;

/// A scanner whose model is taken from its first scans; it does not answer before them.
class LikeItsScans : public EmulatedDevice {
 public:
  LikeItsScans(device::LaserProtocol protocol, EmulatedClock clock)
      : protocol_(protocol), clock_(clock) {}

  void connected(std::int64_t utime) override {
    if (device_) device_->connected(utime);
  }
  void receive(std::string_view bytes, std::int64_t utime) override {
    if (device_) device_->receive(bytes, utime);
  }
  void measured(const device::Measurement& measurement) override {
    if (const auto* scan = std::get_if<laser::Scan>(&measurement); scan != nullptr && !device_) {
      learn(*scan);
    }
    if (device_) device_->measured(measurement);
  }
  std::optional<std::int64_t> deadline() const override {
    return device_ ? device_->deadline() : std::nullopt;
  }
  void advance(std::int64_t utime) override {
    if (!device_) return;
    device_->advance(utime);
    to_send_ += device_->take_to_send();
  }

 private:
  void learn(const laser::Scan& scan) {
    if (scan.ranges_m.size() < 2 || scan.bearing_step_rad == 0.0) return;
    double turn_us = scan.beam_period_us * 2.0 * geometry::kPi / std::abs(scan.bearing_step_rad);
    if (turn_us <= 0.0 && first_utime_) turn_us = static_cast<double>(scan.utime - *first_utime_);
    first_utime_ = scan.utime;
    if (turn_us < 1e3 || turn_us > 1e6) return;
    if (protocol_ == device::LaserProtocol::kCola) {
      ColaDeviceModel model;
      model.name = "emulated";
      model.rate_hz = 1e6 / turn_us;
      device_ = std::make_unique<ColaDevice>(model, clock_);
    } else {
      device_ = std::make_unique<ScipDevice>(scip_model_like(scan, 1e6 / turn_us), clock_);
    }
  }

  device::LaserProtocol protocol_;
  EmulatedClock clock_;
  std::optional<std::int64_t> first_utime_;
  std::unique_ptr<EmulatedDevice> device_;
};

}  // namespace

std::optional<std::int64_t> EmulatedScanner::deadline() const {
  if (sweeps_.empty()) return std::nullopt;
  return sweeps_.front().complete_utime;
}

void EmulatedScanner::advance(std::int64_t utime) {
  for (; !sweeps_.empty() && sweeps_.front().complete_utime <= utime; sweeps_.pop_front()) {
    if (!is_streaming()) continue;
    send(sweeps_.front());
    ++num_sent_;
  }
}

void EmulatedScanner::add(Sweep sweep) {
  sweeps_.push_back(std::move(sweep));
  if (sweeps_.size() > kMaxWaitingSweeps) sweeps_.pop_front();
}

/// What a scanner sends, field by field, in its dialect.
class ColaDevice::Telegram {
 public:
  Telegram(bool is_binary, const std::string& name) : is_binary_(is_binary), content_(name) {
    if (is_binary_) content_ += ' ';
  }

  Telegram& number(std::int64_t value, int num_bytes) {
    const auto bits = static_cast<std::uint32_t>(value);
    if (!is_binary_) return text(fmt::format("{:X}", bits));
    for (int i = num_bytes - 1; i >= 0; --i) content_ += static_cast<char>(bits >> (8 * i) & 0xff);
    return *this;
  }

  Telegram& text(const std::string& text) {
    content_ += (is_binary_ ? "" : " ") + text;
    return *this;
  }

  /// A channel of 16 bits: name, scale 1, offset 0, angles, values.
  Telegram& channel(const std::string& name, const laser::Scan& scan,
                    const std::vector<float>& values, double factor) {
    text(name).number(0x3f800000, 4).number(0, 4).number(start_angle(scan), 4);
    number(std::lround(scan.bearing_step_rad * kUnits_per_rad), 2);
    number(static_cast<std::int64_t>(values.size()), 2);
    for (const float value : values) {
      const double scaled = std::isfinite(value) ? factor * static_cast<double>(value) : 0.0;
      number(std::lround(std::clamp(scaled, 0.0, 65535.0)), 2);
    }
    return *this;
  }

  std::string on_wire() const {
    if (!is_binary_) return "\x02" + content_ + "\x03";
    std::string bytes = "\x02\x02\x02\x02";
    unsigned sum = 0;
    for (const char c : content_) sum ^= static_cast<unsigned char>(c);
    for (int i = 3; i >= 0; --i) bytes += static_cast<char>(content_.size() >> (8 * i) & 0xff);
    return bytes + content_ + static_cast<char>(sum);
  }

 private:
  bool is_binary_;
  std::string content_;
};

ColaDevice::ColaDevice(ColaDeviceModel model, EmulatedClock clock)
    : EmulatedScanner(clock),
      model_(std::move(model)),
      sends_intensities_(model_.sends_intensities) {}

void ColaDevice::connected(std::int64_t) {
  half_telegram_.clear();
  to_send_.clear();
}

void ColaDevice::receive(std::string_view bytes, std::int64_t) {
  for (const char byte : bytes) model_.is_binary ? receive_binary(byte) : receive_text(byte);
}

void ColaDevice::receive_text(char byte) {
  if (byte == '\x02') {
    half_telegram_.clear();
  } else if (byte == '\x03') {
    obey(std::exchange(half_telegram_, {}));
  } else if (half_telegram_.size() < kMaxTelegram) {
    half_telegram_ += byte;
  }
}

void ColaDevice::receive_binary(char byte) {
  std::string& half = half_telegram_;
  half += byte;
  if (half.size() <= 4 && byte != '\x02') half.clear();
  if (half.size() < kBinaryHead) return;
  const auto length = static_cast<std::size_t>(static_cast<unsigned char>(half[7]));
  if (half.size() <= kBinaryHead + length) return;
  unsigned sum = 0;
  for (std::size_t i = kBinaryHead; i < half.size(); ++i) {
    sum ^= static_cast<unsigned char>(half[i]);
  }
  const std::string content = std::exchange(half, {}).substr(kBinaryHead, length);
  if (sum == 0) obey(content);
}

void ColaDevice::answer(const Telegram& telegram) { to_send_ += telegram.on_wire(); }

void ColaDevice::refuse() { answer(Telegram(model_.is_binary, "sFA").number(3, 2)); }

void ColaDevice::obey(const std::string& telegram) {
  const auto begins = [&](const char* text) { return telegram.rfind(text, 0) == 0; };
  const auto reply = [&](const char* name) { return Telegram(model_.is_binary, name); };
  const char last = telegram.empty() ? '\0' : telegram.back();
  if (begins("sEN LMDscandata ")) {
    is_streaming_ = last == (model_.is_binary ? '\1' : '1');
    answer(reply("sEA LMDscandata").number(is_streaming_ ? 1 : 0, 1));
  } else if (telegram == "sRN DeviceIdent") {
    const auto length = static_cast<std::int64_t>(model_.name.size());
    answer(
        reply("sRA DeviceIdent").number(length, 2).text(model_.name).number(6, 2).text("V2.5.0"));
  } else if (telegram == "sRN LMPoutputRange" && last_) {
    const double last_rad = last_->bearing_rad(static_cast<double>(last_->ranges_m.size()) - 1.0);
    answer(reply("sRA LMPoutputRange")
               .number(1, 2)
               .number(std::lround(last_->bearing_step_rad * kUnits_per_rad), 4)
               .number(start_angle(*last_), 4)
               .number(std::lround(last_rad * kUnits_per_rad) + kAhead, 4));
  } else if (begins("sMN SetAccessMode ")) {
    const bool knows = model_.is_binary ? telegram.substr(18) == "\x03\xf4\x72\x47\x44"
                                        : telegram.substr(18) == "03 F4724744";
    is_logged_in_ = model_.allows_login && knows;
    answer(reply("sAN SetAccessMode").number(is_logged_in_ ? 1 : 0, 1));
  } else if (begins("sWN LMDscandatacfg ") && is_logged_in_) {
    const std::string asked = telegram.substr(19);
    sends_intensities_ = model_.is_binary ? asked.substr(0, 3) == std::string("\1\0\1", 3)
                                          : asked.rfind("01 00 1", 0) == 0;
    answer(reply("sWA LMDscandatacfg"));
  } else if (telegram == "sMN Run" && is_logged_in_) {
    is_logged_in_ = false;
    answer(reply("sAN Run").number(1, 1));
  } else {
    refuse();
  }
}

void ColaDevice::measured(const device::Measurement& measurement) {
  const auto* scan = std::get_if<laser::Scan>(&measurement);
  if (scan == nullptr || scan->ranges_m.empty()) return;
  const double beam_period_us =
      1e6 / model_.rate_hz * scan->bearing_step_rad / (2.0 * geometry::kPi);
  const double sweep_us = beam_period_us * static_cast<double>(scan->ranges_m.size() - 1);
  add({scan->utime + static_cast<std::int64_t>(sweep_us) + kSweepProcessing_us, 0, *scan});
  last_ = *scan;
}

void ColaDevice::send(const Sweep& sweep) {
  const laser::Scan& scan = sweep.scan;
  const double first_shot_us =
      std::max(0, start_angle(scan) - kFirstShot) / (360.0 * 10'000.0) * 1e6 / model_.rate_hz;
  const double start_utime = static_cast<double>(scan.utime) - first_shot_us;
  const double end_utime = static_cast<double>(sweep.complete_utime - kSweepProcessing_us);
  const auto ticks = [this](double utime) {
    return static_cast<std::int64_t>(clock_.ticks(utime, 1.0) & 0xffffffff);
  };
  const bool with_intensities = sends_intensities_ && scan.has_intensities();
  Telegram telegram(model_.is_binary, "sSN LMDscandata");
  telegram.number(1, 2).number(1, 2).number(0x89a27f, 4);  // version, device
  telegram.number(0, 1).number(model_.state, 1);           // status
  telegram.number(num_sent_ & 0xffff, 2).number(num_sent_ & 0xffff, 2);
  telegram.number(ticks(model_.stamps_end ? end_utime : start_utime), 4);
  telegram.number(ticks(static_cast<double>(sweep.complete_utime)), 4);
  telegram.number(0, 1).number(0, 1).number(0x3f, 1).number(0, 1).number(0, 2);  // in, out, layer
  telegram.number(std::lround(100.0 * model_.rate_hz), 4).number(0x21c, 4).number(0, 2);
  telegram.number(with_intensities ? 2 : 1, 2).channel("DIST1", scan, scan.ranges_m, 1000.0);
  if (with_intensities) telegram.channel("RSSI1", scan, scan.intensities, 1.0);
  for (int i = 0; i < 6; ++i)
    telegram.number(0, 2);  // 8 bits, position, name, comment, time, event
  answer(telegram);
}

ScipModel ust_10lx() { return {}; }

ScipModel utm_30lx() { return {"UTM-30LX", 23, 60000, 1440, 0, 1080, 540, 2400, 1, false, true}; }

ScipModel urg_04lx_ug01() {
  return {"URG-04LX-UG01(Simple-URG)", 20, 5600, 1024, 44, 725, 384, 600, 0, false, true};
}

ScipModel scip_model_like(const laser::Scan& scan, double rate_hz) {
  const double steps = 2.0 * geometry::kPi / std::abs(scan.bearing_step_rad);
  const auto num_beams = static_cast<int>(scan.ranges_m.size());
  ScipModel model;
  model.name = "emulated";
  model.steps_per_turn = static_cast<int>(std::lround(steps));
  model.first_step = 0;
  model.last_step = std::max(1, num_beams - 1);
  const double last_rad = scan.bearing_rad(num_beams - 1);
  const double right_rad = std::min(scan.bearing_min_rad, last_rad);
  const int ahead = static_cast<int>(std::lround(-right_rad / std::abs(scan.bearing_step_rad)));
  if (ahead >= 0) {
    model.front_step = ahead;
  } else {  // the field of view does not include straight ahead: extrapolate step 0
    model.front_step = 0;
    model.first_step -= ahead;
    model.last_step -= ahead;
  }
  model.range_min_mm = std::max(1, static_cast<int>(std::lround(1e3 * scan.range_min_m)));
  model.range_max_mm = static_cast<int>(std::lround(1e3 * std::min(scan.range_max_m, 200.0)));
  model.rate_rpm = static_cast<int>(std::lround(60.0 * rate_hz));
  model.no_return = 0;
  model.has_intensities = scan.has_intensities();
  return model;
}

ScipDevice::ScipDevice(ScipModel model, EmulatedClock clock)
    : EmulatedScanner(clock), model_(std::move(model)) {}

void ScipDevice::connected(std::int64_t) {
  half_command_.clear();
  to_send_.clear();
}

void ScipDevice::receive(std::string_view bytes, std::int64_t utime) {
  for (const char c : bytes) {
    if (c == '\n' || c == '\r') {
      if (!half_command_.empty()) obey(std::exchange(half_command_, {}), utime);
    } else if (half_command_.size() < kMaxCommand) {
      half_command_ += c;
    }
  }
}

void ScipDevice::answer(const std::string& command, const std::string& status,
                        const std::string& body) {
  to_send_ += command + "\n" + with_sum(status) + "\n" + body + "\n";
}

void ScipDevice::obey(const std::string& command, std::int64_t utime) {
  const std::string symbol = command.substr(0, 2);
  if (symbol == "QT") {
    stream_.clear();
    is_in_clock_mode_ = false;
    answer(command, "00");
  } else if (symbol == "PP" || symbol == "II") {
    describe(command);
  } else if (symbol == "BM") {
    answer(command, "00");
  } else if (symbol == "TM" && model_.has_clock_mode && command.size() == 3) {
    const char code = command[2];
    if (code == '1' && is_in_clock_mode_) {
      const std::uint64_t ticks = clock_.ticks(static_cast<double>(utime), kTick_us) & kClock_mask;
      answer(command, "00", with_sum(encoded(ticks, 4)) + "\n");
    } else if ((code == '0' || code == '2') && (code == '0') != is_in_clock_mode_) {
      is_in_clock_mode_ = code == '0';
      if (is_in_clock_mode_) stream_.clear();
      answer(command, "00");
    } else {
      answer(command, code == '0' ? "02" : code == '1' ? "04" : code == '2' ? "03" : "01");
    }
  } else if (symbol == "MD" || symbol == "MS" || (symbol == "ME" && model_.has_intensities)) {
    obey_stream(command);
  } else {
    answer(command, "0E");
  }
}

void ScipDevice::describe(const std::string& command) {
  const auto number = [](const char* name, int value) {
    return parameter(name + std::to_string(value));
  };
  if (command[0] == 'I') {
    const std::string speed = std::to_string(model_.rate_rpm);
    answer(command, "00",
           parameter("MODL:" + model_.name) + parameter(stream_.empty() ? "LASR:OFF" : "LASR:ON") +
               parameter("SCSP:Initial(" + speed + "[rpm])<-Default setting by user") +
               parameter("STAT:Sensor works well."));
    return;
  }
  answer(command, "00",
         parameter("MODL:" + model_.name + "(Hokuyo Automatic Co.,Ltd.)") +
             number("DMIN:", model_.range_min_mm) + number("DMAX:", model_.range_max_mm) +
             number("ARES:", model_.steps_per_turn) + number("AMIN:", model_.first_step) +
             number("AMAX:", model_.last_step) + number("AFRT:", model_.front_step) +
             number("SCAN:", model_.rate_rpm));
}

void ScipDevice::obey_stream(const std::string& command) {
  const bool is_whole =
      command.size() == 15 &&
      std::all_of(command.begin() + 2, command.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!is_whole) return answer(command, "01");
  const int first = std::stoi(command.substr(2, 4));
  const int last = std::stoi(command.substr(6, 4));
  if (last > model_.last_step) return answer(command, "04");
  if (last < first) return answer(command, "05");
  if (is_in_clock_mode_) return answer(command, "10");
  if (status_ != "00") return answer(command, status_);
  stream_ = command;
  answer(command, "00");
}

void ScipDevice::set_status(const std::string& status) {
  status_ = status;
  if (status_ == "00" || stream_.empty()) return;
  answer(stream_, status_);
  stream_.clear();
}

void ScipDevice::measured(const device::Measurement& measurement) {
  const auto* scan = std::get_if<laser::Scan>(&measurement);
  if (scan == nullptr || scan->ranges_m.empty()) return;
  const double turn_us = 60e6 / model_.rate_rpm;
  const double to_first_us = turn_us * model_.first_step / model_.steps_per_turn;
  const double to_last_us = turn_us * model_.last_step / model_.steps_per_turn;
  const double step_0_utime = static_cast<double>(scan->utime) - to_first_us;
  Sweep sweep;
  sweep.ticks = clock_.ticks(step_0_utime, kTick_us);
  sweep.complete_utime = static_cast<std::int64_t>(step_0_utime + to_last_us) + kSweepProcessing_us;
  sweep.scan = *scan;
  add(std::move(sweep));
}

void ScipDevice::send(const Sweep& sweep) {
  const int num_characters = stream_[1] == 'S' ? 2 : 3;
  const double step_rad = 2.0 * geometry::kPi / model_.steps_per_turn;
  std::string data;
  for (int step = std::stoi(stream_.substr(2, 4)); step <= std::stoi(stream_.substr(6, 4));
       ++step) {
    const Beam beam = beam_at(sweep.scan, (step - model_.front_step) * step_rad, model_);
    data += encoded(beam.range_mm, num_characters);
    if (stream_[1] == 'E') data += encoded(beam.intensity, 3);
  }
  std::string body = with_sum(encoded(sweep.ticks & kClock_mask, 4)) + "\n";
  for (std::size_t begin = 0; begin < data.size(); begin += 64) {
    body += with_sum(data.substr(begin, 64)) + "\n";
  }
  answer(stream_, "99", body);
}

std::unique_ptr<EmulatedDevice> make_emulated_laser(device::LaserProtocol protocol,
                                                    std::int64_t start_utime) {
  return std::make_unique<LikeItsScans>(protocol, EmulatedClock{start_utime, kSkew});
}

}  // namespace orchard::device
