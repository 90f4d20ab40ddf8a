// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "detection/rig.hpp"
#include "device/drivers_config.hpp"
#include "geometry/camera_model.hpp"
#include "io/config/config_file.hpp"
#include "laser/laser_config.hpp"
#include "mapping/mapper_config.hpp"
#include "pose/pose_config.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::io {

/// The complete configuration of a rig: one YAML file, read by every process. A source that
/// includes this header is recompiled whenever a key of any module changes, so only programs and
/// tests include it.
struct Config {
  LcmConfig lcm;
  laser::LaserConfig laser;
  laser::RearLaserConfig laser_rear;
  geometry::CameraConfig camera;
  detection::DetectorConfig detector;
  pose::PoseConfig pose;
  mapping::MapperConfig mapper;
  device::DriversConfig drivers;
  simulation::SimulationConfig simulation;
};

/// A configuration from a log.
struct RecordedConfig {
  Config config;
  std::vector<std::string> notes;  ///< keys that this release does not have, one line per section
};

/// Reads a rig's YAML over the defaults. Throws ConfigError listing all errors at once: unknown
/// keys (with the nearest known one), wrong types, values out of range and violated conditions
/// between keys. Nothing is corrected silently.
Config load_config(const std::string& path);

/// Parses text instead; `name` replaces the path in messages.
Config parse_config(const std::string& yaml, const std::string& name);

/// Parses the configuration that a log holds: keys of another release are ignored and noted.
RecordedConfig parse_recorded_config(const std::string& yaml, const std::string& name);

/// Prints all keys with values, units, ranges and meanings, as YAML that load_config reads.
std::string print_config(const Config& config, PrintedKeys keys = PrintedKeys::kAll);

/// Prints the effective configuration without comments: the text sent in CONFIG and hashed.
std::string effective_config(const Config& config);

/// FNV-1a hash of effective_config().
std::int64_t config_hash(const Config& config);

/// The configuration of a rig, as loaded by a process.
class RigFile : public ConfigFile {
 public:
  RigFile() = default;
  explicit RigFile(Config config) : config_(std::move(config)) {}

  const Config& config() const { return config_; }

  void load(const std::string& path) override;
  LcmConfig& lcm() override { return config_.lcm; }
  EffectiveConfig effective() const override;
  std::string print(PrintedKeys keys) const override { return print_config(config_, keys); }

 private:
  Config config_;
};

/// Default rig of a simulated scene ("tubes", "orchard", "park", "board"): tubes.yaml, orchard.yaml
/// or park.yaml of config/ as of the build, so that it is available wherever the program is
/// installed. Returns the built-in defaults for any other name.
Config scene_rig(std::string_view scene);

}  // namespace orchard::io
