// SPDX-License-Identifier: BSD-3-Clause
#include "cli/simulate.hpp"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <variant>
#include <vector>

#include "bus/codec.hpp"
#include "bus/process.hpp"
#include "cli/simulate_board.hpp"
#include "io/config.hpp"
#include "io/file_error.hpp"
#include "io/log_writer.hpp"
#include "io/observation_csv.hpp"
#include "io/progress_bar.hpp"
#include "io/truth_csv.hpp"
#include "simulation/simulator.hpp"

namespace orchard::cli {
namespace {

bus::Message to_message(const simulation::SensorMessage& sensed) {
  return std::visit([](const auto& m) { return bus::Message(m); }, sensed);
}

/// Writes what the simulator senses; returns the number of messages.
std::int64_t write_log(const SimulateOptions& options, simulation::Simulator& simulator,
                       std::int64_t end_utime, std::int64_t& last_utime) {
  io::LogWriter writer(options.out_path);
  io::ProgressBar bar("simulating");
  std::int64_t num_messages = 0;
  while (const auto sensed = simulator.next()) {
    const bus::Message message = to_message(*sensed);
    const std::int64_t utime = bus::utime_of(message);
    if (options.duration_s > 0.0 && utime > end_utime) break;
    writer.write(utime, bus::info(bus::channel_of(message)).name, bus::encode(message));
    ++num_messages;
    last_utime = utime;
    bar.update(static_cast<std::uint64_t>(utime - simulation::kEpochUtime),
               static_cast<std::uint64_t>(end_utime - simulation::kEpochUtime));
  }
  bar.finish();
  writer.close();
  return num_messages;
}

/// What each scan until `end_utime` truly held.
std::vector<simulation::TrueObservation> observe_all(const simulation::Simulator& simulator,
                                                     std::int64_t end_utime) {
  std::vector<simulation::TrueObservation> all;
  for (std::int64_t scan = 0; scan < simulator.num_scans(); ++scan) {
    if (simulator.scan_utime(scan) > end_utime) break;
    const auto observations = simulator.true_observations(scan);
    all.insert(all.end(), observations.begin(), observations.end());
  }
  return all;
}

}  // namespace

int run_simulate(const SimulateOptions& options) {
  if (options.scene == "board") return run_simulate_board(options);
  const auto scene = simulation::find_scene(options.scene);
  if (!scene) throw io::FileError("there is no scene \"" + options.scene + "\"");
  const io::Config config =
      options.config_path.empty() ? io::Config() : io::load_config(options.config_path);
  const simulation::RigConfig rig{config.laser, config.camera, config.simulation};
  simulation::Simulator simulator(*scene, options.seed, rig);
  std::vector<simulation::TruePose> poses = simulator.true_poses();
  std::int64_t end_utime = poses.empty() ? simulation::kEpochUtime : poses.back().utime;
  if (options.duration_s > 0.0) {
    const auto duration_us = static_cast<std::int64_t>(std::llround(options.duration_s * 1e6));
    end_utime = std::min(end_utime, simulation::kEpochUtime + duration_us);
    poses.erase(std::upper_bound(poses.begin(), poses.end(), end_utime,
                                 [](std::int64_t utime, const simulation::TruePose& pose) {
                                   return utime < pose.utime;
                                 }),
                poses.end());
  }

  std::int64_t last_utime = simulation::kEpochUtime;
  const std::int64_t num_messages = write_log(options, simulator, end_utime, last_utime);
  std::printf("%s: %" PRId64 " messages, %.1f s of scene %s, seed %" PRIu64 "\n",
              options.out_path.c_str(), num_messages,
              static_cast<double>(last_utime - simulation::kEpochUtime) * 1e-6,
              options.scene.c_str(), options.seed);
  if (!options.truth_path.empty()) {
    io::write_truth_csv(options.truth_path, simulator.truth());
    std::printf("%s: %zu things that stand there\n", options.truth_path.c_str(),
                simulator.truth().size());
  }
  if (!options.poses_path.empty()) {
    io::write_poses_csv(options.poses_path, poses);
    std::printf("%s: %zu true poses\n", options.poses_path.c_str(), poses.size());
  }
  if (!options.observations_path.empty()) {
    const auto observations = observe_all(simulator, end_utime);
    io::write_observation_csv(options.observations_path, observations);
    std::printf("%s: %zu true observations\n", options.observations_path.c_str(),
                observations.size());
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
