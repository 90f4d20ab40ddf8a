// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace orchard::device {

/// Checksum of a line: the lower six bits of the sum of its characters, plus 30h (SCIP 2.0, 7).
char scip_sum(std::string_view text);

/// The line without the checksum at its end; none when the checksum is wrong.
std::optional<std::string_view> checked_line(std::string_view line);

/// The same for the lines of PP, VV and II such as "AMIN:44;7"; the checksum leaves out the
/// semicolon.
std::optional<std::string_view> checked_parameter(std::string_view line);

/// Decodes a number of up to five characters of six bits each, 30h for 0 (SCIP 2.0, 6); none when a
/// character is outside 30h to 6fh.
std::optional<std::uint32_t> scip_number(std::string_view characters);

/// The scanner's reply to one command, or one sweep.
struct ScipReply {
  std::string_view echo;               ///< the command as received
  std::string_view status;             ///< two characters, checked
  std::vector<std::string_view> body;  ///< lines with their checksums, not verified yet
};

/// Parses a reply from its echo up to the empty line that ends it. None when it has no echo, or its
/// status is not two characters and their checksum.
std::optional<ScipReply> parse_scip_reply(std::string_view text);

}  // namespace orchard::device
