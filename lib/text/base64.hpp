// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace orchard {

/// Encodes bytes in base 64 with padding (RFC 4648, section 4).
std::string base64_text(const std::uint8_t* data, std::size_t size);

}  // namespace orchard
