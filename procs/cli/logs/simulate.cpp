// SPDX-License-Identifier: BSD-3-Clause
#include "cli/logs/logs.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <variant>
#include <vector>

#include "bus/process/process.hpp"
#include "cli/logs/simulated_rig.hpp"
#include "cli/paths.hpp"
#include "io/file_error.hpp"
#include "io/recording/truth_csv.hpp"
#include "simulation/simulator.hpp"

namespace orchard::cli {
namespace {

/// The requested interval of the scene's time.
struct Interval {
  std::int64_t begin_utime = 0, end_utime = 0;
  bool holds(std::int64_t utime) const { return utime >= begin_utime && utime <= end_utime; }
};

Interval interval_of(const SimulateOptions& options, std::int64_t scene_end_utime) {
  const auto after_us = [](double s) { return static_cast<std::int64_t>(std::llround(s * 1e6)); };
  Interval interval{simulation::kEpochUtime + after_us(options.from_s), scene_end_utime};
  if (interval.begin_utime > scene_end_utime) {
    throw io::FileError(
        fmt::format("--from {:.1f} is after the end of scene {} at {:.1f} s; give a smaller --from",
                    options.from_s, options.scene,
                    1e-6 * static_cast<double>(scene_end_utime - simulation::kEpochUtime)));
  }
  if (options.duration_s > 0.0) {
    interval.end_utime =
        std::min(scene_end_utime, interval.begin_utime + after_us(options.duration_s));
  }
  return interval;
}

}  // namespace

int run_simulate(const SimulateOptions& options) {
  for (const std::string& file : {options.out_path, options.truth_path, options.poses_path}) {
    make_parent_folder(file);
  }
  const auto scene = simulation::find_scene(options.scene);
  if (!scene) throw io::FileError("unknown scene \"" + options.scene + "\"");
  const io::Config config = rig_of(options);
  const simulation::RigConfig rig{config.laser, config.camera, config.simulation,
                                  config.laser_rear};
  simulation::Simulator simulator(*scene, options.seed, rig);
  std::vector<simulation::TruePose> poses = simulator.true_poses();
  const Interval interval =
      interval_of(options, poses.empty() ? simulation::kEpochUtime : poses.back().utime);
  if (options.from_s > 0.0 || options.duration_s > 0.0) {
    poses.erase(std::remove_if(
                    poses.begin(), poses.end(),
                    [&](const simulation::TruePose& pose) { return !interval.holds(pose.utime); }),
                poses.end());
  }

  write_simulated_log(options, config, interval.begin_utime, interval.end_utime,
                      [&simulator]() -> std::optional<bus::Message> {
                        const auto sensed = simulator.next();
                        if (!sensed) return std::nullopt;
                        return std::visit([](const auto& m) { return bus::Message(m); }, *sensed);
                      });
  const io::Heights heights = simulator.is_level() ? io::Heights::kNone : io::Heights::kWritten;
  if (!options.truth_path.empty()) {
    io::write_truth_csv(options.truth_path, simulator.truth(), heights);
    std::printf("%s: %zu true objects\n", options.truth_path.c_str(), simulator.truth().size());
  }
  if (!options.poses_path.empty()) {
    io::write_poses_csv(options.poses_path, poses, heights);
    std::printf("%s: %zu true poses\n", options.poses_path.c_str(), poses.size());
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
