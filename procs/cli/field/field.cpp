// SPDX-License-Identifier: BSD-3-Clause
#include "cli/field/field.hpp"

#include <spdlog/spdlog.h>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <utility>

#include "bus/bus.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/process/process.hpp"
#include "cli/field/status_board.hpp"
#include "io/config/config.hpp"
#include "io/log/log_recorder.hpp"

namespace orchard::cli {

std::string field_url(const FieldOptions& options) {
  io::LcmConfig lcm;
  const bool has_rig = !options.config_path.empty() && options.lcm_url.empty();
  if (has_rig) lcm = io::load_config(options.config_path).lcm;
  const char* why = bus::choose_url(options, has_rig, lcm);
  std::fprintf(stderr, "LCM: %s (%s)\n", lcm.url.c_str(),
               has_rig ? options.config_path.c_str() : why);
  return lcm.url;
}

namespace {

/// `num_kept_off`: datagrams of the last second that the kernel kept from this process.
bus::Status status_of(const io::LogRecorder& recorder, std::int64_t num_kept_off) {
  bus::Status status;
  status.num_good = recorder.num_written();
  status.num_lost = recorder.num_dropped();
  if (!recorder.problem().empty()) {
    status.level = bus::Level::kError;
    status.text = recorder.problem();
  } else {
    char text[128];
    std::snprintf(text, sizeof(text), "%.1f MB recorded, %.1f GB free on the disk",
                  1e-6 * static_cast<double>(recorder.total_bytes()),
                  1e-9 * static_cast<double>(recorder.free_bytes()));
    status.text = text;
  }
  if (num_kept_off > 0) {
    status.level = std::max(status.level, bus::Level::kWarning);
    status.text +=
        "; " + std::to_string(num_kept_off) +
        " datagrams dropped in the last second: malformed, or the receive buffer was full";
  }
  return status;
}

}  // namespace

int run_record(const RecordOptions& options) {
  const std::string url = field_url(options);
  bus::StopSignal stop;
  bus::Bus bus(url);
  io::RecordingLimits limits;
  limits.split_bytes = static_cast<std::int64_t>(1e6 * options.split_mb);
  limits.keep_bytes = static_cast<std::int64_t>(1e9 * options.keep_gb);
  io::LogRecorder recorder(options.folder + "/" + options.name + "-" + start_time_text(), limits);
  spdlog::info("recording to {}; stop with Ctrl-C", recorder.path());
  bus::ProcessReport report(bus, "orchard-recorder", {});
  bus.subscribe_raw([&recorder](const std::string& channel, std::int64_t utime, bus::Bytes bytes) {
    recorder.write(utime, channel, bytes.data, bytes.size);
  });
  std::string said;
  std::int64_t num_kept_off = 0;
  while (!stop.raised()) {
    if (report.due()) {
      recorder.sync();
      if (recorder.problem() != said) {
        said = recorder.problem();
        if (said.empty()) {
          spdlog::info("recording again");
        } else {
          spdlog::error("{}", said);
        }
      }
      const std::int64_t before = std::exchange(num_kept_off, bus.num_dropped());
      report.send(status_of(recorder, num_kept_off - before));
    }
    if (stop.wait(bus.fileno(), report.ms_until_due())) bus.handle(0);
  }
  // Read messages sent before the stop: LCM's thread may not have read all of them.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (std::chrono::steady_clock::now() < end && bus.handle(30)) {
  }
  recorder.sync();
  spdlog::info("{} messages recorded, {} not recorded", recorder.num_written(),
               recorder.num_dropped());
  return recorder.num_dropped() > 0 ? bus::kExitRuntime : bus::kExitOk;
}

namespace {

using Clock = std::chrono::steady_clock;

/// Listening time: STATUS is sent once a second, so every process is heard within it.
constexpr std::chrono::milliseconds kListen{2500};

}  // namespace

int run_status(const StatusOptions& options) {
  const std::string url = field_url(options);
  bus::StopSignal stop;
  bus::Bus bus(url);
  StatusBoard board(bus::machine_name());
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
