// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cli/field/status_board.hpp"

namespace orchard::cli {

/// How a process is in one word: "ok", "waiting", "warning", "error", "silent".
std::string state_word(const ProcessView& process);

/// Whether somebody should look: anything but ok and waiting, or clocks apart.
bool needs_attention(const ProcessView& process);

/// The processes as a table with a header, one line each and its words below; lines are cut at
/// `width` columns (0: not). `colour`: with escape codes for a terminal. What came from outside is
/// printed with its control characters replaced.
std::string status_table(const std::vector<ProcessView>& processes, std::size_t width, bool colour);

/// The lines of one process in that table.
std::string process_lines(const ProcessView& process, std::size_t width, bool colour);

/// The same for programs: one JSON object with a list.
std::string status_json(const std::vector<ProcessView>& processes);

}  // namespace orchard::cli
