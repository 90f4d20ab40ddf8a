// SPDX-License-Identifier: BSD-3-Clause
// true_observations --scene SCENE --seed N --out CSV: what each scan of the log that `orchard
// simulate` makes with the same options could see, with range and occlusion.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "bus/process/process.hpp"
#include "io/config/config.hpp"
#include "simulation/simulator.hpp"
#include "worlds/observation_csv.hpp"
#include "worlds/observation_truth.hpp"

namespace orchard {
namespace {

struct Options {
  std::string scene;
  std::uint64_t seed = 1;
  std::string out_path;
  std::string config_path;
  double from_s = 0.0;
  double duration_s = 0.0;
};

int write_observations(const Options& options) {
  const io::Config config = options.config_path.empty() ? io::scene_rig(options.scene)
                                                        : io::load_config(options.config_path);
  const simulation::RigConfig rig{config.laser, config.camera, config.simulation,
                                  config.laser_rear};
  const simulation::Simulator simulator(simulation::find_scene(options.scene).value(), options.seed,
                                        rig);
  const auto after_us = [](double s) { return static_cast<std::int64_t>(std::llround(s * 1e6)); };
  const std::int64_t begin_utime = simulation::kEpochUtime + after_us(options.from_s);
  std::vector<simulation::TrueObservation> all;
  for (std::int64_t scan = 0; scan < simulator.num_scans(); ++scan) {
    const std::int64_t utime = simulator.scan_utime(scan);
    if (utime < begin_utime) continue;
    if (options.duration_s > 0.0 && utime > begin_utime + after_us(options.duration_s)) break;
    const auto seen = simulation::true_observations(simulator, rig, scan);
    all.insert(all.end(), seen.begin(), seen.end());
  }
  io::write_observation_csv(options.out_path, all);
  std::printf("%s: %zu true observations\n", options.out_path.c_str(), all.size());
  return bus::kExitOk;
}

}  // namespace
}  // namespace orchard

int main(int argc, char** argv) {
  orchard::Options o;
  CLI::App app{"Writes the true observations of a simulated drive.", "true_observations"};
  app.add_option("--scene", o.scene, "scene")
      ->required()
      ->check(CLI::IsMember({"tubes", "orchard", "park", "yard"}));
  app.add_option("--seed", o.seed, "seed of the log");
  app.add_option("--out", o.out_path, "CSV to write")->required();
  app.add_option("--config", o.config_path, "configuration of the rig [that of the scene]");
  app.add_option("--from", o.from_s, "start of the log [s]")->check(CLI::NonNegativeNumber);
  app.add_option("--duration", o.duration_s, "its length [s]; 0 = to the end")
      ->check(CLI::NonNegativeNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    return orchard::write_observations(o);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "true_observations: %s\n", error.what());
    return orchard::bus::kExitInput;
  }
}
