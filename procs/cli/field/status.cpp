// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/status.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "bus/bus.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/process/process.hpp"
#include "cli/field/field_url.hpp"
#include "cli/field/status_board.hpp"
#include "cli/field/status_screen.hpp"
#include "cli/field/status_text.hpp"

namespace orchard::cli {
namespace {

using Clock = std::chrono::steady_clock;

/// Listening time: STATUS is sent once a second, so every process is heard within it.
constexpr std::chrono::milliseconds kListen{2500};

}  // namespace

int run_status(const StatusOptions& options) {
  const std::string url = field_url(options.lcm_url, options.config_path);
  bus::StopSignal stop;
  bus::Bus bus(url);
  StatusBoard board;
  bus.subscribe_status(
      [&board](const bus::Status& status) { board.note(status, bus::wall_utime()); });
  const bool once = options.once || options.json;
  const Clock::time_point end = once ? Clock::now() + kListen : Clock::time_point::max();
  StatusScreen screen;
  if (!once && StatusScreen::is_terminal()) std::printf("\033[2J");
  Clock::time_point next_draw = Clock::now();
  while (!stop.raised() && Clock::now() < end) {
    if (!once && Clock::now() >= next_draw) {
      screen.show(board, "orchard status on " + url + "; stop with Ctrl-C", bus::wall_utime());
      next_draw += kRedraw;
    }
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(
        std::min(end, once ? end : next_draw) - Clock::now());
    if (stop.wait(bus.fileno(), static_cast<int>(std::max<std::int64_t>(0, left.count())))) {
      bus.handle(0);
    }
  }
  if (!once) return bus::kExitOk;
  const std::vector<ProcessView> processes = board.processes(bus::wall_utime());
  std::fputs((options.json ? status_json(processes) : status_table(processes, 0, false)).c_str(),
             stdout);
  const bool well =
      !processes.empty() && std::none_of(processes.begin(), processes.end(), needs_attention);
  return well ? bus::kExitOk : bus::kExitRuntime;
}

}  // namespace orchard::cli
