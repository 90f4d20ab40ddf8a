// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cli/field/status_board.hpp"

namespace orchard::cli {

/// The state of a process in one word: "ok", "waiting", "warning", "error", "silent".
std::string state_word(const ProcessView& process);

/// True if a process needs attention: any state except ok and waiting, or a clock offset.
bool needs_attention(const ProcessView& process);

/// Formats the processes as a table with a header; each has one line, with its text below. Lines
/// are cut at `width` columns (0: not cut). `colour`: with escape codes for a terminal. Control
/// characters in received text are replaced.
std::string status_table(const std::vector<ProcessView>& processes, std::size_t width, bool colour);

/// The lines of one process in the table.
std::string process_lines(const ProcessView& process, std::size_t width, bool colour);

/// The processes as one JSON object with a list.
std::string status_json(const std::vector<ProcessView>& processes);

}  // namespace orchard::cli
