// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "bus/messages/message.hpp"
#include "bus/messages/service_messages.hpp"

namespace orchard::cli {

/// A message as one line: JSON with all its fields, or words with long arrays shortened. Names are
/// those of lcmtypes/*.lcm.
std::string message_text(const bus::Message& message, bool json);
std::string message_text(const bus::Status& status, bool json);
std::string message_text(const bus::ConfigNotice& notice, bool json);
std::string message_text(const bus::Ack& ack, bool json);
std::string message_text(const bus::ReplayMark& mark, bool json);

}  // namespace orchard::cli
