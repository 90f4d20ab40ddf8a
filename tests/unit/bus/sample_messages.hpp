// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "bus/messages/fields.hpp"

namespace orchard::bus::testing {

/// The head of a JPEG up to its frame header, and a few bytes more: all that the guard reads.
inline std::vector<std::uint8_t> jpeg_head(int width_px, int height_px) {
  const auto high = [](int value) { return static_cast<std::uint8_t>(value >> 8); };
  const auto low = [](int value) { return static_cast<std::uint8_t>(value & 255); };
  std::vector<std::uint8_t> head;
  for (const int byte : {0xFF, 0xD8, 0xFF, 0xE0, 0, 4, 1, 2, 0xFF, 0xC0, 0, 17, 8}) {
    head.push_back(low(byte));
  }
  for (const int px : {height_px, width_px}) {
    head.push_back(high(px));
    head.push_back(low(px));
  }
  for (const int byte : {3, 1, 0x22, 0, 2, 0x11, 1, 3, 0x11, 1, 7}) head.push_back(low(byte));
  return head;
}

/// Visitor that sets every field to a value of its own within its limits.
class FieldFiller {
 public:
  FieldFiller(std::int64_t utime, std::int32_t seq) : utime_(utime), seq_(seq) {}

  void stamp(std::int64_t& utime, std::int32_t& seq) {
    utime = utime_;
    seq = seq_;
  }
  void time(const char*, std::int64_t& utime) { utime = utime_ + ++num_; }
  template <class T, class Lo, class Hi>
  void field(const char*, T& value, Lo lo, Hi hi) {
    ++num_;
    if constexpr (std::is_same_v<T, bool>) {
      value = true;
    } else if constexpr (std::is_floating_point_v<T>) {
      const double fraction = 0.2 + 0.002 * num_;
      value = static_cast<T>(lo + fraction * (static_cast<double>(hi) - static_cast<double>(lo)));
    } else {
      value = static_cast<T>(
          std::min(static_cast<std::int64_t>(lo) + num_, static_cast<std::int64_t>(hi)));
    }
  }
  template <class T, std::size_t N, class Lo, class Hi>
  void field(const char* name, std::array<T, N>& values, Lo lo, Hi hi) {
    for (T& value : values) field(name, value, lo, hi);
  }
  template <std::size_t N>
  void covariance(const char* name, std::array<double, N>& values) {
    field(name, values, 0.0, 1.0);
  }
  template <class T>
  void count(const char*, std::vector<T>& values) {
    values.resize(3);
  }
  template <class T>
  void array(const char* name, std::vector<T>& values, const char*) {
    for (T& value : values) field(name, value, 1, 99);
  }
  template <class T, class Lo, class Hi>
  void array(const char* name, std::vector<T>& values, const char*, Lo lo, Hi hi) {
    for (T& value : values) field(name, value, lo, hi);
  }
  template <class T, class Member, class Lo, class Hi>
  void column(const char* name, std::vector<T>& values, const char*, Member T::*member, Lo lo,
              Hi hi) {
    for (T& value : values) field(name, value.*member, lo, hi);
  }
  template <class T, class Fields>
  void items(const char*, std::vector<T>& values, const char*, Fields) {
    for (T& value : values) Fields::visit(value, *this);
  }

 private:
  std::int64_t utime_;
  std::int32_t seq_;
  int num_ = 0;
};

// What a message needs besides values within limits.
template <class M>
void complete(M&) {}
inline void complete(vision::Image& image) {
  image.width_px = 320;
  image.height_px = 240;
  image.encoding = vision::Encoding::kJpeg;
  image.data = jpeg_head(320, 240);
}

inline void complete(mapping::MapWays& ways) {
  ways.part = ways.num_parts - 1;
  for (mapping::Way& way : ways.ways) way.num_points = 1;
}

/// One well-formed message of each source and derived channel, every field set to something.
template <std::size_t kIndex = 0>
std::vector<Message> sample_messages(std::int64_t utime = 1700000000000000, std::int32_t seq = 3) {
  std::variant_alternative_t<kIndex, Message> message;
  FieldFiller filler(utime, seq);
  visit_fields(message, filler);
  complete(message);
  std::vector<Message> all{std::move(message)};
  if constexpr (kIndex + 1 < std::variant_size_v<Message>) {
    for (Message& next : sample_messages<kIndex + 1>(utime, seq)) all.push_back(std::move(next));
  }
  return all;
}

}  // namespace orchard::bus::testing
