// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bus/messages/fields.hpp"

namespace orchard::bus {

/// Visitor that compares each field with its limits and keeps the first violation. See fields.hpp.
class FieldCheck {
 public:
  void stamp(std::int64_t utime, std::int32_t seq) {
    time("utime", utime);
    field("seq", seq, 0, INT32_MAX);
  }
  void time(const char* name, std::int64_t utime) {
    field(name, utime, std::int64_t{0}, kUtimeEnd - 1);
  }
  template <class T, class Lo, class Hi>
  void field(const char* name, T value, Lo lo, Hi hi) {
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) return refuse(Reason::kNotFinite, name, std::to_string(value));
      if (!(value >= lo && value <= hi)) {
        refuse(Reason::kOutOfRange, name, std::to_string(value));
      }
    } else {
      const auto number = static_cast<std::int64_t>(value);
      if (number < static_cast<std::int64_t>(lo) || number > static_cast<std::int64_t>(hi)) {
        refuse(Reason::kOutOfRange, name, std::to_string(number));
      }
    }
  }
  template <class T, std::size_t N, class Lo, class Hi>
  void field(const char* name, const std::array<T, N>& values, Lo lo, Hi hi) {
    for (const T& value : values) field(name, value, lo, hi);
  }
  template <std::size_t N>
  void covariance(const char* name, const std::array<double, N>& values) {
    static_assert(N == 3 || N == 6, "an upper triangle of 2 x 2 or 3 x 3");
    field(name, values, -1e12, 1e12);
    std::size_t diagonal = 0;
    for (std::size_t row = N == 3 ? 2 : 3; row > 0; --row) {
      field("covariance diagonal", values[diagonal], 0.0, 1e12);
      diagonal += row;
    }
  }
  template <class T>
  void count(const char*, const std::vector<T>&) {}
  template <class T>
  void array(const char*, const std::vector<T>&, const char*) {}
  template <class T, class Lo, class Hi>
  void array(const char* name, const std::vector<T>& values, const char*, Lo lo, Hi hi) {
    for (const T& value : values) field(name, value, lo, hi);
  }
  template <class T, class Fields>
  void items(const char*, const std::vector<T>& values, const char*, Fields) {
    for (const T& value : values) {
      Fields::visit(value, *this);
      if (rejection_) return;
    }
  }
  template <class T, class Member, class Lo, class Hi>
  void column(const char* name, const std::vector<T>& values, const char*, Member T::*member, Lo lo,
              Hi hi) {
    for (const T& value : values) field(name, value.*member, lo, hi);
  }
  void text(const char*, const std::string&) {}

  /// Checks a condition that involves more than one field.
  void require(bool condition, Reason reason, const char* detail) {
    if (!condition && !rejection_) rejection_ = Rejection{reason, detail};
  }
  bool ok() const { return !rejection_; }
  std::optional<Rejection> result() && { return std::move(rejection_); }

 private:
  void refuse(Reason reason, const char* name, const std::string& value) {
    if (!rejection_) rejection_ = Rejection{reason, std::string(name) + " = " + value};
  }
  std::optional<Rejection> rejection_;
};

}  // namespace orchard::bus
