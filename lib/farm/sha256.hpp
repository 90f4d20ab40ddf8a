// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace orchard::farm {

/// SHA-256 digest of bytes added in pieces. Source: FIPS 180-4, sections 4.1.2 to 6.2.
class Sha256 {
 public:
  void add(const void* bytes, std::size_t size);

  /// Returns the digest of all bytes added, as 64 hexadecimal digits. Nothing may be added
  /// afterwards.
  std::string hex();

 private:
  void take_block(const std::uint8_t* block);

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::uint8_t, 64> pending_{};
  std::size_t num_pending_ = 0;
  std::uint64_t num_bytes_ = 0;
};

/// SHA-256 digest of a text.
std::string sha256_hex(std::string_view text);

}  // namespace orchard::farm
