// SPDX-License-Identifier: BSD-3-Clause
#include "farm/sha256.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::farm {
namespace {

/// First 32 bits of the fractional parts of the cube roots of the first 64 primes.
std::array<std::uint32_t, 64> round_constants() {
  std::array<std::uint32_t, 64> constants{};
  std::size_t num = 0;
  for (std::uint64_t n = 2; num < constants.size(); ++n) {
    bool is_prime = true;
    for (std::uint64_t d = 2; d * d <= n; ++d) is_prime = is_prime && n % d != 0;
    if (!is_prime) continue;
    // The cube root of n times 2^32, bit by bit: exact, independent of floating-point rounding.
    std::uint64_t root = 0;
    for (int bit = 34; bit >= 0; --bit) {
      const auto next = static_cast<unsigned __int128>(root | (std::uint64_t{1} << bit));
      // next^3 <= n * 2^96 fits into 128 bits, because next < 2^35.
      if (next * next * next <= (static_cast<unsigned __int128>(n) << 96)) {
        root |= std::uint64_t{1} << bit;
      }
    }
    constants[num++] = static_cast<std::uint32_t>(root);
  }
  return constants;
}

std::uint32_t rotated(std::uint32_t x, int n) { return (x >> n) | (x << (32 - n)); }

std::uint32_t big_endian(const std::uint8_t* bytes) {
  return static_cast<std::uint32_t>(bytes[0]) << 24 | static_cast<std::uint32_t>(bytes[1]) << 16 |
         static_cast<std::uint32_t>(bytes[2]) << 8 | bytes[3];
}

}  // namespace

void Sha256::take_block(const std::uint8_t* block) {
  static const std::array<std::uint32_t, 64> kConstants = round_constants();
  std::array<std::uint32_t, 64> w{};
  for (std::size_t i = 0; i < 16; ++i) w[i] = big_endian(block + 4 * i);
  for (std::size_t i = 16; i < 64; ++i) {
    const std::uint32_t s0 = rotated(w[i - 15], 7) ^ rotated(w[i - 15], 18) ^ (w[i - 15] >> 3);
    const std::uint32_t s1 = rotated(w[i - 2], 17) ^ rotated(w[i - 2], 19) ^ (w[i - 2] >> 10);
    w[i] = w[i - 16] + s0 + w[i - 7] + s1;
  }
  auto [a, b, c, d, e, f, g, h] = state_;
  for (std::size_t i = 0; i < 64; ++i) {
    const std::uint32_t s1 = rotated(e, 6) ^ rotated(e, 11) ^ rotated(e, 25);
    const std::uint32_t t1 = h + s1 + ((e & f) ^ (~e & g)) + kConstants[i] + w[i];
    const std::uint32_t s0 = rotated(a, 2) ^ rotated(a, 13) ^ rotated(a, 22);
    const std::uint32_t t2 = s0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g, g = f, f = e, e = d + t1;
    d = c, c = b, b = a, a = t1 + t2;
  }
  const std::array<std::uint32_t, 8> sum{a, b, c, d, e, f, g, h};
  for (std::size_t i = 0; i < 8; ++i) state_[i] += sum[i];
}

void Sha256::add(const void* bytes, std::size_t size) {
  const auto* next = static_cast<const std::uint8_t*>(bytes);
  num_bytes_ += size;
  while (size > 0) {
    if (num_pending_ == 0 && size >= pending_.size()) {
      take_block(next);
      next += pending_.size();
      size -= pending_.size();
      continue;
    }
    const std::size_t num = std::min(size, pending_.size() - num_pending_);
    std::copy(next, next + num, pending_.begin() + static_cast<std::ptrdiff_t>(num_pending_));
    num_pending_ += num;
    next += num;
    size -= num;
    if (num_pending_ == pending_.size()) {
      take_block(pending_.data());
      num_pending_ = 0;
    }
  }
}

std::string Sha256::hex() {
  const std::uint64_t num_bits = 8 * num_bytes_;
  const std::uint8_t one = 0x80, zero = 0;
  add(&one, 1);
  while (num_pending_ != 56) add(&zero, 1);
  std::array<std::uint8_t, 8> length{};
  for (std::size_t i = 0; i < 8; ++i) {
    length[i] = static_cast<std::uint8_t>(num_bits >> (56 - 8 * i));
  }
  add(length.data(), length.size());
  std::string text;
  for (const std::uint32_t word : state_) {
    for (int shift = 28; shift >= 0; shift -= 4) text += "0123456789abcdef"[(word >> shift) & 15];
  }
  return text;
}

std::string sha256_hex(std::string_view text) {
  Sha256 digest;
  digest.add(text.data(), text.size());
  return digest.hex();
}

}  // namespace orchard::farm
