// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "bus/messages/codec.hpp"
#include "bus/messages/message.hpp"

namespace orchard::bus {

/// Checks that the fields of a message are consistent with each other and with its arrays. Expects
/// each field to be within its own limits. Returns the first violation, or none.
std::optional<Rejection> check_consistency(const Message& message);

}  // namespace orchard::bus
