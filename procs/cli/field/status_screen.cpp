// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/status_screen.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>

#include "cli/field/status_text.hpp"

namespace orchard::cli {
namespace {

std::size_t terminal_width() {
  winsize size{};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 100;
}

}  // namespace

bool StatusScreen::is_terminal() { return isatty(STDOUT_FILENO) != 0; }

void StatusScreen::show(const StatusBoard& board, const std::string& headline,
                        std::int64_t now_utime) {
  const std::vector<ProcessView> processes = board.processes(now_utime);
  if (!is_terminal()) return print_changes(processes);
  // Move home, overwrite, clear the rest: this flickers less than clearing the whole screen.
  std::string text = headline + "\n" + status_table(processes, terminal_width(), true);
  std::string drawn = "\033[H";
  for (const char c : text) drawn += c == '\n' ? std::string("\033[K\n") : std::string(1, c);
  std::printf("%s\033[J", drawn.c_str());
  std::fflush(stdout);
}

void StatusScreen::print_changes(const std::vector<ProcessView>& processes) {
  for (const ProcessView& process : processes) {
    // Numbers in the text change every second: compare the text without digits.
    std::string key = state_word(process);
    for (const char c : process.status.text) {
      if (c < '0' || c > '9') key += c;
    }
    std::string& said = said_[process.status.host + "/" + process.status.name];
    if (said == key) continue;
    said = key;
    std::printf("%s", process_lines(process, 0, false).c_str());
  }
  std::fflush(stdout);
}

}  // namespace orchard::cli
