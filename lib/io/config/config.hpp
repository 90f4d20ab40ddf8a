// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "detection/detector_config.hpp"
#include "device/drivers_config.hpp"
#include "geometry/camera_config.hpp"
#include "io/config/config_error.hpp"
#include "io/config/config_file.hpp"
#include "laser/laser_config.hpp"
#include "mapping/mapper_config.hpp"
#include "pose/pose_config.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::io {

/// The whole configuration of a rig: one YAML file, read by every process. Whoever includes this
/// header is compiled anew whenever a key of any room changes: only programs and tests do.
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

/// A rig's configuration and what the reader warned of: keys that were renamed or are fixed now.
struct LoadedConfig {
  Config config;
  std::vector<std::string> warnings;  ///< one line each
};

/// Reads a rig's YAML over the defaults. Throws ConfigError naming every unknown key (with its
/// nearest neighbour), wrong type, value out of range and crossed limit at once; repairs nothing.
LoadedConfig load_config_with_warnings(const std::string& path);

/// The same from text; `name` stands for the file in messages.
LoadedConfig parse_config_with_warnings(const std::string& yaml, const std::string& name);

/// The same for who has nobody to warn.
Config load_config(const std::string& path);
Config parse_config(const std::string& yaml, const std::string& name);

/// All keys with values, units, ranges and meanings, as YAML that load_config reads.
std::string print_config(const Config& config, PrintedKeys keys = PrintedKeys::kAll);

/// The effective configuration without comments: what CONFIG carries and the hash is of.
std::string effective_config(const Config& config);

/// FNV-1a of effective_config().
std::int64_t config_hash(const Config& config);

/// A rig's configuration as a process loads it.
class RigFile : public ConfigFile {
 public:
  RigFile() = default;
  explicit RigFile(Config config) : config_(std::move(config)) {}

  const Config& config() const { return config_; }

  std::vector<std::string> load(const std::string& path) override;
  LcmConfig& lcm() override { return config_.lcm; }
  EffectiveConfig effective() const override;
  std::string print(PrintedKeys keys) const override { return print_config(config_, keys); }

 private:
  Config config_;
};

}  // namespace orchard::io
