// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace orchard::ros {

/// Serialisation format of a message.
enum class Wire {
  kRos1,  ///< packed, little-endian (ROS wiki, "msg": serialisation)
  kCdr,   ///< four bytes of header, then aligned (OMG DDSI-RTPS 2.3, 10; XCDR version 1)
};

/// Reads the fields of a ROS message in sequence, never beyond its bytes.
///
/// Missing fields read as 0 or empty, and ok() is false from then on: a decoder reads all its
/// fields and checks once.
class RosReader {
 public:
  /// The bytes must outlive the reader.
  RosReader(const void* data, std::size_t size, Wire wire);

  template <class T>
  T number() {
    T value{};
    const std::uint8_t* bytes = take(sizeof(T), sizeof(T));
    if (bytes != nullptr) std::memcpy(&value, ordered(bytes, sizeof(T)), sizeof(T));
    return value;
  }

  /// Reads a string; empty, and not ok, when it does not end within the bytes.
  std::string text();

  /// Reads a sequence of bytes and its size; the result points into the message. Null when none.
  const std::uint8_t* bytes(std::size_t& size);

  /// Reads the number of elements of a sequence, each of at least `least_element_bytes` bytes; not
  /// ok when the remaining bytes are too few.
  std::size_t count(std::size_t least_element_bytes);

  /// Reads a sequence of single-precision numbers.
  std::vector<float> floats();

  Wire wire() const { return wire_; }
  bool ok() const { return ok_; }

 private:
  const std::uint8_t* take(std::size_t size, std::size_t alignment);
  const std::uint8_t* ordered(const std::uint8_t* bytes, std::size_t size);

  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t position_ = 0;
  Wire wire_;
  bool is_big_endian_ = false;
  bool ok_ = true;
  std::uint8_t swapped_[8] = {};
};

}  // namespace orchard::ros
