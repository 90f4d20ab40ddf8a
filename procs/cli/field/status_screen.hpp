// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cli/field/status_board.hpp"

namespace orchard::cli {

/// Period of redrawing the screen.
inline constexpr std::chrono::milliseconds kRedraw{500};

/// Prints the status of all processes: a redrawn table on a terminal; in a pipe, a line whenever
/// the state or text of a process changes.
class StatusScreen {
 public:
  /// `headline`: lines above the table.
  void show(const StatusBoard& board, const std::string& headline, std::int64_t now_utime);

  /// True if standard output is a terminal.
  static bool is_terminal();

 private:
  void print_changes(const std::vector<ProcessView>& processes);
  std::map<std::string, std::string> said_;
};

}  // namespace orchard::cli
