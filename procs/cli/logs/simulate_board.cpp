// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/logs.hpp"

#include <algorithm>
#include <stdexcept>

#include "bus/process/process.hpp"
#include "cli/logs/simulated_rig.hpp"
#include "cli/paths.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
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
  const double length_s = options.duration_s > 0.0
                              ? std::min(options.duration_s, scene.duration_s())
                              : scene.duration_s();
  write_simulated_log(options, config, simulation::kEpochUtime,
                      simulation::kEpochUtime + static_cast<std::int64_t>(1e6 * length_s),
                      [&scene]() -> std::optional<bus::Message> {
                        const auto sensed = scene.next();
                        if (!sensed) return std::nullopt;
                        return std::visit([](const auto& m) { return bus::Message(m); }, *sensed);
                      });
  return bus::kExitOk;
}

}  // namespace orchard::cli
