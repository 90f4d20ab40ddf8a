// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace orchard::device {

/// The sum of a line: the lower six bits of the sum of its characters, plus 30h (SCIP 2.0, 7).
char scip_sum(std::string_view text);

/// The line without the sum at its end; none when the sum is wrong.
std::optional<std::string_view> checked_line(std::string_view line);

/// The same for the lines of PP, VV and II, "AMIN:44;7": the semicolon is not summed.
std::optional<std::string_view> checked_parameter(std::string_view line);

/// A number of up to five characters of six bits each, 30h for 0 (SCIP 2.0, 6); none when a
/// character is outside of 30h to 6fh.
std::optional<std::uint32_t> scip_number(std::string_view characters);

/// What the scanner answers to one command, or sends for one sweep.
struct ScipReply {
  std::string_view echo;               ///< the command as it was understood
  std::string_view status;             ///< two characters, checked
  std::vector<std::string_view> body;  ///< lines with their sums, not checked yet
};

/// Reads a reply, from its echo to before the empty line that ends it. None when it has no echo or
/// its status is not two characters and their sum.
std::optional<ScipReply> parse_scip_reply(std::string_view text);

}  // namespace orchard::device
