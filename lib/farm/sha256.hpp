// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace orchard::farm {

/// SHA-256 digest of bytes added in pieces, by OpenSSL's libcrypto. Throws std::runtime_error when
/// that refuses (a system whose policy has no SHA-256).
class Sha256 {
 public:
  Sha256();
  void add(const void* bytes, std::size_t size);

  /// Returns the digest of all bytes added, as 64 hexadecimal digits. Nothing may be added
  /// afterwards.
  std::string hex();

 private:
  std::shared_ptr<void> context_;
};

/// SHA-256 digest of a text.
std::string sha256_hex(std::string_view text);

}  // namespace orchard::farm
