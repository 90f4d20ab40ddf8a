// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
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

/// Visitor that computes LCM's hash of the type that fields describe: from their names, types and
/// dimensions, in order (lcm-gen 1.3.1). Equal hashes mean that fields and .lcm file agree.
class TypeHash {
 public:
  void stamp(std::int64_t, std::int32_t) {
    member("utime", "int64_t");
    member("seq", "int32_t");
  }
  void time(const char* name, std::int64_t) { member(name, "int64_t"); }
  template <class T, class Lo, class Hi>
  void field(const char* name, const T&, Lo, Hi) {
    member(name, type_name<T>());
  }
  template <class T, std::size_t N, class Lo, class Hi>
  void field(const char* name, const std::array<T, N>&, Lo, Hi) {
    fixed_array(name, type_name<T>(), N);
  }
  template <std::size_t N>
  void covariance(const char* name, const std::array<double, N>&) {
    fixed_array(name, "double", N);
  }
  template <class T>
  void count(const char* name, const std::vector<T>&) {
    member(name, "int32_t");
  }
  template <class T, class... Limits>
  void array(const char* name, const std::vector<T>&, const char* count, Limits...) {
    variable_array(name, type_name<T>(), count);
  }
  template <class T, class Fields>
  void items(const char* name, const std::vector<T>&, const char* count, Fields) {
    variable_array(name, "", count);
    const T element{};
    TypeHash nested;
    Fields::visit(element, nested);
    of_nested_ += static_cast<std::uint64_t>(nested.value());
  }
  template <class T, class Member, class Lo, class Hi>
  void column(const char* name, const std::vector<T>&, const char* count, Member T::*, Lo, Hi) {
    variable_array(name, type_name<Member>(), count);
  }
  void text(const char* name, const std::string&) { member(name, "string"); }

  std::int64_t value() const {
    const std::uint64_t sum = hash_ + of_nested_;
    return static_cast<std::int64_t>((sum << 1) + (sum >> 63));
  }

 private:
  template <class T>
  static const char* type_name() {
    if constexpr (std::is_enum_v<T>) return type_name<std::underlying_type_t<T>>();
    if (std::is_same_v<T, double>) return "double";
    if (std::is_same_v<T, float>) return "float";
    if (std::is_same_v<T, std::uint8_t>) return "byte";
    return sizeof(T) == 8 ? "int64_t" : sizeof(T) == 4 ? "int32_t" : "int8_t";
  }
  void update(int c) {
    const auto turned = static_cast<std::uint64_t>(static_cast<std::int64_t>(hash_) >> 55);
    hash_ = ((hash_ << 8) ^ turned) + static_cast<std::uint64_t>(static_cast<std::int64_t>(c));
  }
  void update(std::string_view text) {
    update(static_cast<int>(text.size()));
    for (const char c : text) update(static_cast<int>(c));
  }
  void begin(const char* name, const char* type, int num_dimensions) {
    update(std::string_view(name));
    if (*type != '\0') update(std::string_view(type));
    update(num_dimensions);
  }
  void member(const char* name, const char* type) { begin(name, type, 0); }
  void fixed_array(const char* name, const char* type, std::size_t size) {
    begin(name, type, 1);
    update(0);
    update(std::to_string(size));
  }
  void variable_array(const char* name, const char* type, const char* count) {
    begin(name, type, 1);
    update(1);
    update(std::string_view(count));
  }

  std::uint64_t hash_ = 0x12345678;
  std::uint64_t of_nested_ = 0;
};

}  // namespace orchard::bus::testing
