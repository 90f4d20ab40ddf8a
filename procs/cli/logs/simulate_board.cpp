// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/simulate_board.hpp"

#include <cinttypes>
#include <cstdio>
#include <stdexcept>

#include "bus/messages/codec.hpp"
#include "bus/process/process.hpp"
#include "cli/interruptible_work.hpp"
#include "cli/logs/simulated_rig.hpp"
#include "cli/parent_folder.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "io/log/log_writer.hpp"
#include "simulation/board_scene.hpp"
#include "simulation/simulator.hpp"

namespace orchard::cli {
namespace {

simulation::BoardScene make_scene(const SimulateOptions& options, const io::Config& config) {
  try {
    return simulation::BoardScene(options.seed,
                                  {config.laser, config.camera, config.simulation, {}});
  } catch (const std::invalid_argument& error) {
    throw io::FileError(options.config_path + ": " + error.what());
  }
}

}  // namespace

int run_simulate_board(const SimulateOptions& options) {
  if (!options.truth_path.empty() || !options.poses_path.empty()) {
    throw io::FileError(
        "--truth and --poses do not apply to scene board: its truth is "
        "camera.delta_m and camera.phi_rad of --config");
  }
  if (options.from_s > 0.0)
    throw io::FileError("--from does not apply to scene board; leave it out");
  make_parent_folder(options.out_path);
  const io::Config config = rig_of(options);
  simulation::BoardScene scene = make_scene(options, config);
  InterruptibleWork work("simulating");
  io::LogWriter writer(options.out_path);
  std::int64_t num_messages = 0;
  std::int64_t last_utime = simulation::kEpochUtime;
  while (const auto sensed = scene.next()) {
    const bus::Message message = std::visit([](const auto& m) { return bus::Message(m); }, *sensed);
    const std::int64_t utime = bus::utime_of(message);
    const double time_s = static_cast<double>(utime - simulation::kEpochUtime) * 1e-6;
    if (options.duration_s > 0.0 && time_s > options.duration_s) break;
    if (num_messages == 0) {
      write_rig(writer, config, utime);
      ++num_messages;
    }
    writer.write(utime, bus::info(bus::channel_of(message)).name, bus::encode(message));
    last_utime = utime;
    ++num_messages;
    work.update(static_cast<std::uint64_t>(1e3 * time_s),
                static_cast<std::uint64_t>(1e3 * scene.duration_s()));
  }
  work.finish();
  writer.close();
  std::printf("%s: %" PRId64 " messages, %.1f s of scene board, seed %" PRIu64 "\n",
              options.out_path.c_str(), num_messages,
              static_cast<double>(last_utime - simulation::kEpochUtime) * 1e-6, options.seed);
  return bus::kExitOk;
}

}  // namespace orchard::cli
