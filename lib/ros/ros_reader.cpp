// SPDX-License-Identifier: BSD-3-Clause
#include "ros/ros_reader.hpp"

#include <algorithm>

namespace orchard::ros {
namespace {

constexpr std::size_t kCdrHeaderBytes = 4;

}  // namespace

RosReader::RosReader(const void* data, std::size_t size, Wire wire)
    : data_(static_cast<const std::uint8_t*>(data)), size_(size), wire_(wire) {
  if (wire_ == Wire::kRos1) return;
  // The second byte is the byte order: 0 big, 1 little endian. Other values mean parameter lists or
  // XCDR version 2, which ROS does not send.
  if (size < kCdrHeaderBytes || data_[0] != 0 || data_[1] > 1) {
    ok_ = false;
    size_ = 0;
    return;
  }
  is_big_endian_ = data_[1] == 0;
  data_ += kCdrHeaderBytes;  // alignment is relative to the end of the header
  size_ -= kCdrHeaderBytes;
}

const std::uint8_t* RosReader::take(std::size_t size, std::size_t alignment) {
  std::size_t begin = position_;
  if (wire_ == Wire::kCdr) begin = (begin + alignment - 1) / alignment * alignment;
  if (!ok_ || begin > size_ || size > size_ - begin) {
    ok_ = false;
    return nullptr;
  }
  position_ = begin + size;
  return data_ + begin;
}

const std::uint8_t* RosReader::ordered(const std::uint8_t* bytes, std::size_t size) {
  if (!is_big_endian_) return bytes;
  std::reverse_copy(bytes, bytes + size, swapped_);
  return swapped_;
}

std::string RosReader::text() {
  std::size_t size = number<std::uint32_t>();
  const std::uint8_t* begin = take(size, 1);
  if (begin == nullptr) return {};
  // The length of a CDR string includes its terminating zero; ROS 1 strings have none.
  if (wire_ == Wire::kCdr && size > 0 && begin[size - 1] == 0) --size;
  return std::string(reinterpret_cast<const char*>(begin), size);
}

const std::uint8_t* RosReader::bytes(std::size_t& size) {
  size = number<std::uint32_t>();
  const std::uint8_t* begin = take(size, 1);
  if (begin == nullptr) size = 0;
  return begin;
}

std::size_t RosReader::count(std::size_t least_element_bytes) {
  const std::size_t count = number<std::uint32_t>();
  if (count * least_element_bytes > size_ - std::min(position_, size_)) {
    ok_ = false;
    return 0;
  }
  return ok_ ? count : 0;
}

std::vector<float> RosReader::floats() {
  std::vector<float> values(count(sizeof(float)));
  for (float& value : values) value = number<float>();
  if (!ok_) values.clear();
  return values;
}

}  // namespace orchard::ros
