// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace orchard::io {

/// The bytes of a number, little-endian, which is the byte order of x86 and ARM.
template <class T>
std::string number_bytes(T value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// The bytes of a text after its size, as ByteFields::text() reads them.
inline std::string text_bytes(std::string_view text) {
  return number_bytes(static_cast<std::uint32_t>(text.size())).append(text);
}

/// Reads consecutive little-endian numbers and length-prefixed texts from bytes. Reading beyond the
/// end gives 0 or empty values, and ok() is false from then on.
class ByteFields {
 public:
  ByteFields(const std::uint8_t* bytes, std::size_t size) : bytes_(bytes), size_(size) {}
  explicit ByteFields(std::string_view bytes)
      : ByteFields(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()) {}

  template <class T>
  T number() {
    T value{};
    if (const std::uint8_t* begin = take(sizeof(T))) std::memcpy(&value, begin, sizeof(T));
    return value;
  }
  std::string text() {
    const std::size_t size = number<std::uint32_t>();
    const std::uint8_t* begin = take(size);
    return begin ? std::string(reinterpret_cast<const char*>(begin), size) : std::string();
  }
  const std::uint8_t* take(std::uint64_t size) {
    if (!ok_ || size > size_ - position_) {
      ok_ = false;
      return nullptr;
    }
    const std::uint8_t* begin = bytes_ + position_;
    position_ += static_cast<std::size_t>(size);
    return begin;
  }
  std::size_t left() const { return size_ - position_; }
  bool ok() const { return ok_; }

 private:
  const std::uint8_t* bytes_;
  std::size_t size_;
  std::size_t position_ = 0;
  bool ok_ = true;
};

}  // namespace orchard::io
