// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bus/messages/message.hpp"
#include "bus/messages/service_messages.hpp"

namespace orchard::cli {

/// Formats a message as one line: JSON with all fields, or text with long arrays shortened. Field
/// names are those of lcmtypes/*.lcm.
std::string message_text(const bus::Message& message, bool json);
std::string message_text(const bus::Status& status, bool json);
std::string message_text(const bus::ConfigNotice& notice, bool json);
std::string message_text(const bus::Ack& ack, bool json);
std::string message_text(const bus::ReplayMark& mark, bool json);

}  // namespace orchard::cli
