// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/messages/field_writer.hpp"

namespace orchard::bus {

/// Visitor that reads fields in LCM's encoding from untrusted bytes. The first error stops the
/// reading with a rejection, and no array is allocated that the remaining bytes cannot fill. See
/// fields.hpp.
class FieldReader {
 public:
  FieldReader(const std::uint8_t* data, std::size_t size, std::size_t position)
      : data_(data), size_(size), position_(position) {}

  void stamp(std::int64_t& utime, std::int32_t& seq) {
    get("utime", utime);
    get("seq", seq);
  }
  void time(const char* name, std::int64_t& utime) { get(name, utime); }
  template <class T, class Lo, class Hi>
  void field(const char* name, T& value, Lo, Hi) {
    get(name, value);
  }
  template <std::size_t N>
  void covariance(const char* name, std::array<double, N>& values) {
    get(name, values);
  }
  template <class T>
  void count(const char* name, std::vector<T>&) {
    std::int32_t count = 0;
    get(name, count);
    counts_.emplace_back(name, static_cast<std::uint32_t>(count));
  }
  template <class T>
  void array(const char* name, std::vector<T>& values, const char* count) {
    if (!size_for(values, count, sizeof(T))) return;
    if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
      const std::uint8_t* next = data_ + position_;  // size_for() has found all bytes there
      for (T& value : values) {
        const auto bits = bits_at<T>(next);
        std::memcpy(&value, &bits, sizeof(T));
        next += sizeof(T);
      }
      position_ += values.size() * sizeof(T);
    } else {
      for (T& value : values) get(name, value);
    }
  }
  void array(const char*, std::vector<std::uint8_t>& values, const char* count) {
    const std::optional<std::size_t> size = count_of(count, 1);
    if (!size) return;
    values.assign(data_ + position_, data_ + position_ + *size);
    position_ += *size;
  }
  template <class T, class Lo, class Hi>
  void array(const char* name, std::vector<T>& values, const char* count, Lo, Hi) {
    array(name, values, count);
  }
  template <class T, class Fields>
  void items(const char*, std::vector<T>& values, const char* count, Fields) {
    const T nothing{};
    FieldWriter one;
    Fields::visit(nothing, one);
    if (!size_for(values, count, one.size())) return;
    for (T& value : values) Fields::visit(value, *this);
  }
  template <class T, class Member, class Lo, class Hi>
  void column(const char* name, std::vector<T>& values, const char* count, Member T::*member, Lo,
              Hi) {
    if (!size_for(values, count, sizeof(Member))) return;
    for (T& value : values) get(name, value.*member);
  }
  void text(const char* name, std::string& value) {
    // The length includes the terminating zero; an inner zero is refused, as LCM's encoder would
    // cut the string there.
    std::uint32_t length = 0;
    get(name, length);
    if (rejection_) return;
    const auto* begin = reinterpret_cast<const char*>(data_ + position_);
    if (length < 1 || length > size_ - position_ ||
        std::memchr(begin, 0, length) != begin + length - 1) {
      return refuse(Reason::kBadCount, "a string of " + std::to_string(length) + " bytes");
    }
    value.assign(begin, length - 1);
    position_ += length;
  }

  /// Returns why the bytes are invalid, or none; call it after all fields were visited.
  std::optional<Rejection> result() && {
    if (!rejection_ && position_ != size_) {
      refuse(Reason::kBadCount,
             "its counts give " + std::to_string(position_) + " bytes of " + std::to_string(size_));
    }
    return std::move(rejection_);
  }

 private:
  /// The big-endian number at an address.
  template <class T>
  static WireBits<sizeof(T)> bits_at(const std::uint8_t* at) {
    WireBits<sizeof(T)> bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits = static_cast<WireBits<sizeof(T)>>(static_cast<std::uint64_t>(bits) << 8 | at[i]);
    }
    return bits;
  }

  void refuse(Reason reason, std::string detail) {
    if (!rejection_) rejection_ = Rejection{reason, std::move(detail)};
  }

  template <class T>
  void get(const char* name, T& value) {
    if (rejection_) return;
    if (size_ - position_ < sizeof(T)) {
      return refuse(Reason::kTooShort, std::string("ends before ") + name);
    }
    const auto bits = bits_at<T>(data_ + position_);
    position_ += sizeof(T);
    if constexpr (std::is_same_v<T, bool>) {
      if (bits > 1) {
        const int number = static_cast<std::int8_t>(bits);
        return refuse(Reason::kUndecodable, std::string(name) + " = " + std::to_string(number));
      }
      value = bits == 1;
    } else {
      std::memcpy(&value, &bits, sizeof(T));
    }
  }
  template <class T, std::size_t N>
  void get(const char* name, std::array<T, N>& values) {
    for (T& value : values) get(name, value);
  }

  /// Number of elements of an array, if the remaining bytes can hold that many.
  std::optional<std::size_t> count_of(const char* count_name, std::size_t element_bytes) {
    if (rejection_) return std::nullopt;
    // Use the latest count of that name: array items may have counts of their own.
    for (auto entry = counts_.rbegin(); entry != counts_.rend(); ++entry) {
      const auto& [name, count] = *entry;
      if (std::strcmp(name, count_name) != 0) continue;
      if (count <= (size_ - position_) / element_bytes) return count;
      refuse(Reason::kBadCount,
             std::string(name) + " = " + std::to_string(static_cast<std::int32_t>(count)));
      return std::nullopt;
    }
    refuse(Reason::kUndecodable, std::string("no field ") + count_name);
    return std::nullopt;
  }
  /// Resizes an array to its count if the remaining bytes can hold that many elements.
  template <class T>
  bool size_for(std::vector<T>& values, const char* count_name, std::size_t element_bytes) {
    const std::optional<std::size_t> count = count_of(count_name, element_bytes);
    if (count) values.resize(*count);
    return count.has_value();
  }

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t position_;
  std::vector<std::pair<const char*, std::uint32_t>> counts_;
  std::optional<Rejection> rejection_;
};

}  // namespace orchard::bus
