// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace orchard::io {

/// Decompresses data of a bag: bz2, lz4 (frame format) and zstd; "" or "none" is a copy.
///
/// Fills `unpacked`, whose size the caller has set to the size given in the file. Returns an empty
/// string, or the reason for failure: unknown compression, damage, or another size.
std::string unpack(const std::string& compression, const std::uint8_t* data, std::size_t size,
                   std::vector<std::uint8_t>& unpacked);

/// Whether the bytes begin like a zstd frame; rosbag2 compresses single messages that way.
bool is_zstd(const std::uint8_t* data, std::size_t size);

/// Returns the content size given in a zstd frame; 0 if none is given or it exceeds `most_bytes`.
std::size_t zstd_size(const std::uint8_t* data, std::size_t size, std::size_t most_bytes);

}  // namespace orchard::io
