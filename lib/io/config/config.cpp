// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config.hpp"

#include <utility>

#include "io/atomic_file.hpp"
#include "io/config/config_file.hpp"
#include "io/config/config_visitor.hpp"
#include "io/config/config_yaml.hpp"
#include "io/file_error.hpp"

namespace orchard::io {
namespace {

/// A rig has about 10 kB. A much larger file is not a rig, or it never ends.
constexpr std::size_t kConfigBytesMax = std::size_t{1} << 20;

/// Presents all sections of a configuration, which must outlive the returned schema.
ConfigSchema schema_of(Config& c) {
  return [&c](ConfigVisitor& v) {
    v.section("lcm", c.lcm, "LCM network");
    v.section("laser", c.laser, "pose of the laser on the robot, and its noise");
    v.expert().section("laser_rear", c.laser_rear, "pose and noise of a second laser");
    v.section("camera", c.camera, "camera: intrinsics, and extrinsics to the laser");
    v.section("detector", c.detector, "detector: from scans and pictures to detections");
    v.section("pose", c.pose, "localisation of the robot");
    v.section("mapper", c.mapper, "mapper: from detections and poses to the map");
    v.section("drivers", c.drivers, "sensors that are connected to this machine");
    v.section("simulation", c.simulation, "simulated world and sensors");
  };
}

}  // namespace

Config parse_config(const std::string& yaml, const std::string& name) {
  Config config;
  read_yaml(yaml, name, schema_of(config));
  return config;
}

RecordedConfig parse_recorded_config(const std::string& yaml, const std::string& name) {
  RecordedConfig recorded;
  recorded.notes = read_yaml(yaml, name, schema_of(recorded.config), UnknownKeys::kNote);
  return recorded;
}

Config load_config(const std::string& path) {
  try {
    return parse_config(read_file(path, kConfigBytesMax, "give an existing rig with --config"),
                        path);
  } catch (const FileError& error) {
    throw ConfigError({error.what()});
  }
}

std::string print_config(const Config& config, PrintedKeys keys) {
  Config copy = config;
  if (keys == PrintedKeys::kAll) return print_all_keys(schema_of(copy));
  Config defaults;
  return print_user_keys(schema_of(copy), schema_of(defaults));
}

std::string effective_config(const Config& config) {
  Config copy = config;
  return print_values(schema_of(copy));
}

/// The LCM network does not affect results, so it is not part of the hash.
std::int64_t config_hash(const Config& config) {
  Config copy = config;
  copy.lcm = LcmConfig();
  return text_hash(effective_config(copy));
}

void RigFile::load(const std::string& path) { config_ = load_config(path); }

EffectiveConfig RigFile::effective() const {
  return {effective_config(config_), config_hash(config_)};
}

}  // namespace orchard::io
