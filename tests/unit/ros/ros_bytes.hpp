// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace orchard::ros_test {

/// Bytes of a message put together by hand: packed as ROS 1 does, or aligned as CDR is.
class Bytes {
 public:
  enum class Kind { kRos1, kCdrLittle, kCdrBig };
  explicit Bytes(Kind kind) : kind_(kind) {
    if (kind != Kind::kRos1) bytes_ = {0, std::uint8_t(kind == Kind::kCdrLittle), 0, 0};
  }
  template <class T>
  Bytes& put(T value) {
    while (kind_ != Kind::kRos1 && (bytes_.size() - 4) % sizeof(T) != 0) bytes_.push_back(0);
    std::uint8_t raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (kind_ == Kind::kCdrBig) std::reverse(raw, raw + sizeof(T));
    bytes_.insert(bytes_.end(), raw, raw + sizeof(T));
    return *this;
  }
  Bytes& text(const std::string& value) {
    const bool has_end = kind_ != Kind::kRos1;
    put(static_cast<std::uint32_t>(value.size() + (has_end ? 1 : 0)));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    if (has_end) bytes_.push_back(0);
    return *this;
  }
  Bytes& header(std::uint32_t seconds, std::uint32_t nanoseconds, const std::string& frame) {
    if (kind_ == Kind::kRos1) put(std::uint32_t{7});  // seq
    return put(seconds).put(nanoseconds).text(frame);
  }
  Bytes& raw(const std::vector<std::uint8_t>& data) {
    put(static_cast<std::uint32_t>(data.size()));
    bytes_.insert(bytes_.end(), data.begin(), data.end());
    return *this;
  }
  const std::uint8_t* data() const { return bytes_.data(); }
  std::size_t size() const { return bytes_.size(); }

 private:
  Kind kind_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace orchard::ros_test
