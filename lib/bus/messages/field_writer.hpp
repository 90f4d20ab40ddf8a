// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace orchard::bus {

/// Unsigned integer type with the size of a number on the wire.
template <std::size_t kBytes>
using WireBits = std::conditional_t<kBytes == 1, std::uint8_t,
                                    std::conditional_t<kBytes == 4, std::uint32_t, std::uint64_t>>;

/// Visitor that writes fields in LCM's encoding: big-endian, without padding. See fields.hpp.
class FieldWriter {
 public:
  FieldWriter() = default;
  explicit FieldWriter(std::int64_t type_hash) { put(type_hash); }

  void stamp(std::int64_t utime, std::int32_t seq) {
    put(utime);
    put(seq);
  }
  void time(const char*, std::int64_t utime) { put(utime); }
  template <class T, class Lo, class Hi>
  void field(const char*, const T& value, Lo, Hi) {
    put(value);
  }
  template <std::size_t N>
  void covariance(const char*, const std::array<double, N>& values) {
    put(values);
  }
  template <class T>
  void count(const char*, const std::vector<T>& values) {
    put(static_cast<std::int32_t>(values.size()));
  }
  template <class T>
  void array(const char*, const std::vector<T>& values, const char*) {
    for (const T& value : values) put(value);
  }
  void array(const char*, const std::vector<std::uint8_t>& values, const char*) {
    bytes_.insert(bytes_.end(), values.begin(), values.end());
  }
  template <class T, class Lo, class Hi>
  void array(const char* name, const std::vector<T>& values, const char* count, Lo, Hi) {
    array(name, values, count);
  }
  template <class T, class Fields>
  void items(const char*, const std::vector<T>& values, const char*, Fields) {
    for (const T& value : values) Fields::visit(value, *this);
  }
  template <class T, class Member, class Lo, class Hi>
  void column(const char*, const std::vector<T>& values, const char*, Member T::*member, Lo, Hi) {
    for (const T& value : values) put(value.*member);
  }
  /// Writes the string up to its first zero, as LCM's encoder does; the length includes the
  /// terminating zero.
  void text(const char*, const std::string& value) {
    const std::size_t length = std::strlen(value.c_str()) + 1;
    put(static_cast<std::int32_t>(length));
    bytes_.insert(bytes_.end(), value.c_str(), value.c_str() + length);
  }

  std::vector<std::uint8_t> bytes() && { return std::move(bytes_); }
  std::size_t size() const { return bytes_.size(); }

 private:
  template <class T>
  void put(T value) {
    WireBits<sizeof(T)> bits;
    std::memcpy(&bits, &value, sizeof(T));
    std::array<std::uint8_t, sizeof(T)> big_endian;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      big_endian[i] = static_cast<std::uint8_t>(bits >> (8 * (sizeof(T) - 1 - i)) & 0xFF);
    }
    bytes_.insert(bytes_.end(), big_endian.begin(), big_endian.end());
  }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& values) {
    for (const T& value : values) put(value);
  }

  std::vector<std::uint8_t> bytes_;
};

}  // namespace orchard::bus
