// SPDX-License-Identifier: BSD-3-Clause
#include "sim_driver/sim_source.hpp"

#include <stdexcept>
#include <variant>

#include "io/recording/truth_csv.hpp"
#include "text/parse_number.hpp"

namespace orchard::procs {
namespace {

std::uint64_t parse_seed(const std::string& text) {
  if (const auto seed = parse_number<std::uint64_t>(text)) return *seed;
  throw std::invalid_argument("--seed " + text + ": must be a whole number from 0 on");
}

}  // namespace

SimSource::SimSource(simulation::SceneKind kind, std::uint64_t seed,
                     const simulation::RigConfig& rig)
    : simulator_(kind, seed, rig) {}

std::optional<bus::Message> SimSource::next() {
  std::optional<simulation::SensorMessage> sensed = simulator_.next();
  if (!sensed) return std::nullopt;
  return std::visit([](auto& m) { return bus::Message(std::move(m)); }, *sensed);
}

std::optional<double> SimSource::duration_s() const {
  if (simulator_.num_scans() == 0) return std::nullopt;
  return 1e-6 * static_cast<double>(simulator_.scan_utime(simulator_.num_scans() - 1) -
                                    simulation::kEpochUtime);
}

std::unique_ptr<SimSource> make_sim_source(const SimDriverOptions& options,
                                           const io::Config& config) {
  const auto kind = simulation::find_scene(options.scene);
  if (!kind) {
    throw std::invalid_argument("--scene " + options.scene +
                                ": must be tubes, orchard, park or yard");
  }
  const simulation::RigConfig rig{config.laser, config.camera, config.simulation,
                                  config.laser_rear};
  auto source = std::make_unique<SimSource>(*kind, parse_seed(options.seed), rig);
  const io::Heights heights =
      source->simulator().is_level() ? io::Heights::kNone : io::Heights::kWritten;
  if (!options.truth_path.empty()) {
    io::write_truth_csv(options.truth_path, source->simulator().truth(), heights);
  }
  if (!options.poses_path.empty()) {
    io::write_poses_csv(options.poses_path, source->simulator().true_poses(), heights);
  }
  return source;
}

}  // namespace orchard::procs
