// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "bus/messages/codec.hpp"
#include "bus/messages/message.hpp"

namespace orchard::bus {

/// Why a message whose fields are each within their limits cannot be what it says, by what its
/// fields say of each other and of its arrays; none when it can be.
std::optional<Rejection> check_consistency(const Message& message);

}  // namespace orchard::bus
