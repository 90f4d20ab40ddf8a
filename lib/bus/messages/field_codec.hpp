// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/messages/fields.hpp"
#include "timing/drive_time.hpp"

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

  /// The receiver finds the epoch of a drive time by itself.
  void stamp(std::int64_t drive_time, std::int32_t seq) {
    put(timing::utime_of(drive_time));
    put(seq);
  }
  void time(const char*, std::int64_t drive_time) { put(timing::utime_of(drive_time)); }
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
    std::uint8_t* to = grow(sizeof(T) * values.size());
    for (const T& value : values) to = store(value, to);
  }
  void array(const char*, const std::vector<std::uint8_t>& values, const char*) {
    std::copy(values.begin(), values.end(), grow(values.size()));
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
    std::memcpy(grow(length), value.c_str(), length);
  }

  std::vector<std::uint8_t> bytes() && {
    bytes_.resize(size_);
    return std::move(bytes_);
  }
  std::size_t size() const { return size_; }

 private:
  /// The place of that many more bytes.
  std::uint8_t* grow(std::size_t num) {
    if (size_ + num > bytes_.size()) bytes_.resize(std::max(2 * bytes_.size(), size_ + num));
    size_ += num;
    return bytes_.data() + (size_ - num);
  }
  /// Writes a value in big-endian order and returns the place behind it.
  template <class T>
  static std::uint8_t* store(T value, std::uint8_t* to) {
    WireBits<sizeof(T)> bits;
    std::memcpy(&bits, &value, sizeof(T));
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      *to++ = static_cast<std::uint8_t>(bits >> (8 * (sizeof(T) - 1 - i)) & 0xFF);
    }
    return to;
  }
  template <class T>
  void put(T value) {
    store(value, grow(sizeof(T)));
  }
  template <class T, std::size_t N>
  void put(const std::array<T, N>& values) {
    for (const T& value : values) put(value);
  }

  // derived: POSE, ODOMETRY and IMU, the most frequent ones, fit in.
  static constexpr std::size_t kFirst_bytes = 128;
  std::vector<std::uint8_t> bytes_ = std::vector<std::uint8_t>(kFirst_bytes);
  std::size_t size_ = 0;
};

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

/// Encodes a message as LCM bytes.
template <class M>
std::vector<std::uint8_t> encode_fields(Channel channel, const M& message) {
  FieldWriter writer(type_hash(channel));
  visit_fields(message, writer);
  return std::move(writer).bytes();
}

/// Decodes a message and checks its size, type hash, array counts and field limits. Invalid bytes
/// never throw. `Fields` describes the wire layout of the bytes, which may be that of an older
/// version.
template <class M, class Fields>
std::variant<M, Rejection> decode_fields(Channel channel, const void* data, std::size_t size,
                                         Fields) {
  static const std::size_t min_bytes = encode_fields(channel, M{}).size();
  if (auto rejection = check_head(channel, data, size, min_bytes)) return *std::move(rejection);
  M message;
  FieldReader reader(static_cast<const std::uint8_t*>(data), size, sizeof(std::int64_t));
  Fields::visit(message, reader);
  if (auto rejection = std::move(reader).result()) return *std::move(rejection);
  FieldCheck check;
  Fields::visit(std::as_const(message), check);
  if (auto rejection = std::move(check).result()) return *std::move(rejection);
  return message;
}

}  // namespace orchard::bus
