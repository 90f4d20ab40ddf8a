// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace orchard::io {

/// The compressions of bags: bz2, lz4 (its frames) and zstd; "" or "none" is none.
///
/// Fills `unpacked`, which the caller made as long as the file says it is. Returns why it could
/// not: unknown, damaged, or of another length; empty when it could.
std::string unpack(const std::string& compression, const std::uint8_t* data, std::size_t size,
                   std::vector<std::uint8_t>& unpacked);

/// Whether bytes begin as zstd's frames do; rosbag2 compresses single messages so.
bool is_zstd(const std::uint8_t* data, std::size_t size);

/// The length that a frame of zstd states; 0 when it states none or more than `most_bytes`.
std::size_t zstd_size(const std::uint8_t* data, std::size_t size, std::size_t most_bytes);

}  // namespace orchard::io
