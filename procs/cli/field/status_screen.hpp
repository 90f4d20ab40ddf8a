// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "cli/field/status_board.hpp"

namespace orchard::cli {

/// How often the screen is drawn anew.
inline constexpr std::chrono::milliseconds kRedraw{500};

/// Shows how all processes are: a table that is drawn anew on a terminal; in a pipe a line whenever
/// a process's state or words change.
class StatusScreen {
 public:
  /// `headline`: lines above the table.
  void show(const StatusBoard& board, const std::string& headline, std::int64_t now_utime);

  /// Whether standard output is a terminal.
  static bool is_terminal();

 private:
  void print_changes(const std::vector<ProcessView>& processes);
  std::map<std::string, std::string> said_;
};

}  // namespace orchard::cli
