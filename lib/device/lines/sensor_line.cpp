// SPDX-License-Identifier: BSD-3-Clause
#include "device/lines/sensor_line.hpp"

#include <charconv>
#include <cmath>
#include <vector>

namespace orchard::device {
namespace {

constexpr double kSpeedMax_mps = 50.0;  // no vehicle among trees
constexpr double kYawRateMax_radps = 50.0;
constexpr double kAngularRateMax_radps = 100.0;  // above what inertial units measure (2000 deg/s)
constexpr double kAccelerationMax_mps2 = 400.0;
constexpr double kAngleMax_rad = 12.6;  // two turns, for who does not wrap
constexpr std::size_t kMaxWords = 16;

constexpr std::string_view kSeparators = " \t,";

/// Words between blanks or commas; at most kMaxWords and one.
std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  while (words.size() <= kMaxWords) {
    const std::size_t begin = line.find_first_not_of(kSeparators);
    if (begin == std::string_view::npos) break;
    line.remove_prefix(begin);
    const std::size_t end = line.find_first_of(kSeparators);
    words.push_back(line.substr(0, end));
    if (end == std::string_view::npos) break;
    line.remove_prefix(end);
  }
  return words;
}

template <class Number>
std::optional<Number> read_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') {
    word.remove_prefix(1);
    if (word.empty() || word.front() == '-') return std::nullopt;
  }
  Number number{};
  const auto result = std::from_chars(word.data(), word.data() + word.size(), number);
  if (result.ec != std::errc() || result.ptr != word.data() + word.size()) return std::nullopt;
  return number;
}

std::optional<std::uint8_t> read_hex_byte(std::string_view text) {
  std::uint8_t byte = 0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), byte, 16);
  if (text.size() != 2 || result.ec != std::errc() || result.ptr != text.data() + text.size()) {
    return std::nullopt;
  }
  return byte;
}

/// The words behind a line's letter as numbers, each checked; keeps the first objection.
class Numbers {
 public:
  explicit Numbers(const std::vector<std::string_view>& words) : words_(words) {}

  std::size_t count() const { return words_.size(); }

  double real(double lo, double hi) {
    if (!why_.empty()) return 0.0;
    const std::string_view word = words_[next_++];
    const std::optional<double> number = read_number<double>(word);
    if (!number || !std::isfinite(*number)) {
      why_ = "not a number: " + std::string(word);
    } else if (*number < lo || *number > hi) {
      why_ = "out of range: " + std::string(word);
    } else {
      return *number;
    }
    return 0.0;
  }

  void reals(std::array<double, 3>& values, double limit) {
    for (double& value : values) value = real(-limit, limit);
  }

  std::int64_t whole() {
    if (!why_.empty()) return 0;
    const std::string_view word = words_[next_++];
    const std::optional<std::int64_t> number = read_number<std::int64_t>(word);
    if (!number) why_ = "not a whole number: " + std::string(word);
    return number.value_or(0);
  }

  const std::string& why() const { return why_; }

 private:
  const std::vector<std::string_view>& words_;
  std::size_t next_ = 0;
  std::string why_;
};

/// Fills a line by its letter; returns why not, or nothing.
std::string fill(SensorLine& line, std::string_view letter, Numbers& numbers) {
  const std::size_t count = numbers.count();
  if (letter == "V") {
    if (count != 2 && count != 4)
      return "V needs speed and yaw rate, optionally with their standard deviations";
    VelocityLine velocity;
    velocity.speed_mps = numbers.real(-kSpeedMax_mps, kSpeedMax_mps);
    velocity.yaw_rate_radps = numbers.real(-kYawRateMax_radps, kYawRateMax_radps);
    if (count == 4) {
      velocity.speed_sd_mps = numbers.real(0.0, kSpeedMax_mps);
      velocity.yaw_rate_sd_radps = numbers.real(0.0, kYawRateMax_radps);
    }
    line.content = velocity;
  } else if (letter == "T") {
    if (count != 2) return "T needs the counts of the left and the right wheel";
    TickLine ticks;
    ticks.left = numbers.whole();
    ticks.right = numbers.whole();
    line.content = ticks;
  } else if (letter == "I") {
    if (count != 6 && count != 9)
      return "I needs 3 rates and 3 accelerations, optionally with 3 angles";
    InertialLine inertial;
    numbers.reals(inertial.angular_rate_radps, kAngularRateMax_radps);
    numbers.reals(inertial.acceleration_mps2, kAccelerationMax_mps2);
    inertial.has_orientation = count == 9;
    if (inertial.has_orientation) numbers.reals(inertial.orientation_rad, kAngleMax_rad);
    line.content = inertial;
  } else {
    return "begins with none of V, T, I and #";
  }
  return numbers.why();
}

}  // namespace

std::uint8_t line_checksum(std::string_view bytes) {
  std::uint8_t sum = 0;
  for (const char byte : bytes)
    sum = static_cast<std::uint8_t>(sum ^ static_cast<std::uint8_t>(byte));
  return sum;
}

std::variant<SensorLine, Comment, BadLine> parse_sensor_line(std::string_view text) {
  if (!text.empty() && text.front() == '#') return Comment{};
  SensorLine line;
  if (const std::size_t star = text.rfind('*'); star != std::string_view::npos) {
    const std::optional<std::uint8_t> stated = read_hex_byte(text.substr(star + 1));
    if (!stated) return BadLine{"the checksum is not two hexadecimal digits"};
    text = text.substr(0, star);
    if (*stated != line_checksum(text)) return BadLine{"the checksum is wrong"};
    line.has_checksum = true;
  }
  std::vector<std::string_view> words = split_words(text);
  if (words.empty()) return Comment{};
  if (words.size() > kMaxWords) return BadLine{"too many words"};
  if (words.back().front() == '@') {
    const auto time = read_number<std::int64_t>(words.back().substr(1));
    if (!time || *time < 0) return BadLine{"@ needs a time in whole microseconds"};
    line.device_time_us = *time;
    words.pop_back();
    if (words.empty()) return BadLine{"a time without a measurement"};
  }
  const std::string_view letter = words.front();
  words.erase(words.begin());
  Numbers numbers(words);
  if (std::string why = fill(line, letter, numbers); !why.empty()) return BadLine{std::move(why)};
  return line;
}

}  // namespace orchard::device
