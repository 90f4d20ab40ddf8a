// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace orchard::io {

/// Whether so few packed bytes of a recording may become so many. More were made to exhaust who
/// unpacks them.
inline bool is_plausibly_packed(std::uint64_t packed_bytes, std::uint64_t unpacked_bytes) {
  // physical: LZ4's block format, in which most recorders pack, cannot exceed 255 to 1.
  constexpr std::uint64_t kRatioMax = 255;
  // derived: one message of the largest size, however well it packs.
  constexpr std::uint64_t kSpareBytes = std::uint64_t{64} << 20;
  return unpacked_bytes <= kSpareBytes + kRatioMax * packed_bytes;
}

}  // namespace orchard::io
