// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

namespace orchard::bus::testing {

/// Visitor that keeps each field as text with every digit, by its name: "POSE.x_m",
/// "POSE.covariance[1]", "DETECTIONS.trunks[0].width_m".
class FieldValues {
 public:
  explicit FieldValues(std::map<std::string, std::string>& texts, const std::string& prefix)
      : texts_(texts), prefix_(prefix + ".") {}

  void stamp(std::int64_t utime, std::int32_t seq) {
    put("utime", utime);
    put("seq", seq);
  }
  void time(const char* name, std::int64_t utime) { put(name, utime); }
  template <class T, class Lo, class Hi>
  void field(const char* name, const T& value, Lo, Hi) {
    put(name, value);
  }
  template <std::size_t N>
  void covariance(const char* name, const std::array<double, N>& values) {
    put(name, values);
  }
  template <class T>
  void count(const char* name, const std::vector<T>& values) {
    put(name, values.size());
  }
  template <class T, class... Limits>
  void array(const char* name, const std::vector<T>& values, const char*, Limits...) {
    put(name, values);
  }
  template <class T, class Fields>
  void items(const char* name, const std::vector<T>& values, const char*, Fields) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      FieldValues nested(texts_, prefix_ + element(name, i));
      Fields::visit(values[i], nested);
    }
  }
  template <class T, class Member, class Lo, class Hi>
  void column(const char* name, const std::vector<T>& values, const char*, Member T::*member, Lo,
              Hi) {
    for (std::size_t i = 0; i < values.size(); ++i) put(element(name, i), values[i].*member);
  }
  void text(const char* name, const std::string& value) {
    std::string line;  // a text of several lines as one
    for (const char c : value) line += c == '\n' ? std::string("\\n") : std::string(1, c);
    texts_[prefix_ + name] = line;
  }

 private:
  static std::string element(const std::string& name, std::size_t i) {
    return name + "[" + std::to_string(i) + "]";
  }
  template <class T>
  void put(const std::string& name, const T& value) {
    if constexpr (std::is_enum_v<T>) {
      put(name, static_cast<int>(value));
    } else if constexpr (std::is_arithmetic_v<T>) {
      std::ostringstream text;
      text.precision(17);
      text << +value;
      texts_[prefix_ + name] = text.str();
    } else {
      for (std::size_t i = 0; i < value.size(); ++i) put(element(name, i), value[i]);
    }
  }

  std::map<std::string, std::string>& texts_;
  std::string prefix_;
};

}  // namespace orchard::bus::testing
