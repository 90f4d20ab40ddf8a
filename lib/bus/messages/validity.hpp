// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "bus/messages/codec.hpp"
#include "bus/messages/message.hpp"

namespace orchard::bus {

/// The first moment no message may carry: 2200-01-01 [us].
inline constexpr std::int64_t kUtimeEnd = 7258118400000000;

/// Why a decoded message cannot be what it says (not finite, out of range, contradicting its own
/// sizes), or none when it can be.
std::optional<Rejection> check_content(const Message& message);

}  // namespace orchard::bus
