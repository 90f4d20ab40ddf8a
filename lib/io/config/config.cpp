// SPDX-License-Identifier: BSD-3-Clause
#include "io/config/config.hpp"

#include <fstream>
#include <utility>

#include "io/config/config_visitor.hpp"
#include "io/config/text_hash.hpp"
#include "io/config/yaml_printer.hpp"
#include "io/config/yaml_reader.hpp"

namespace orchard::io {
namespace {

/// A rig has about 10 kB. A much larger file is not a rig, or it never ends.
constexpr std::size_t kConfigBytesMax = 1 << 20;

/// Presents all sections of a configuration, which must outlive the returned schema.
ConfigSchema schema_of(Config& c) {
  return [&c](ConfigVisitor& v) {
    v.section("lcm", c.lcm, "messages");
    v.section("laser", c.laser, "laser mount and noise");
    v.expert().section("laser_rear", c.laser_rear, "a second laser's mount and noise");
    v.section("camera", c.camera, "camera intrinsics and extrinsics");
    v.section("detector", c.detector, "scan and image to detections");
    v.section("pose", c.pose, "where the robot is");
    v.section("mapper", c.mapper, "detections to the map");
    v.section("drivers", c.drivers, "the sensors of this machine");
    v.section("simulation", c.simulation, "the simulated world and its sensors");
  };
}

}  // namespace

LoadedConfig parse_config_with_warnings(const std::string& yaml, const std::string& name) {
  LoadedConfig loaded;
  loaded.warnings = read_yaml(yaml, name, schema_of(loaded.config));
  return loaded;
}

LoadedConfig load_config_with_warnings(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(kConfigBytesMax + 1, '\0');
  if (!file || !file.read(text.data(), static_cast<std::streamsize>(text.size())).eof()) {
    if (file.gcount() > static_cast<std::streamsize>(kConfigBytesMax)) {
      throw ConfigError({path + ": is larger than any configuration (1 MiB); is it one?"});
    }
    throw ConfigError({path + ": cannot be read; give an existing file with --config"});
  }
  text.resize(static_cast<std::size_t>(file.gcount()));
  return parse_config_with_warnings(text, path);
}

Config parse_config(const std::string& yaml, const std::string& name) {
  return parse_config_with_warnings(yaml, name).config;
}

Config load_config(const std::string& path) { return load_config_with_warnings(path).config; }

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

std::vector<std::string> RigFile::load(const std::string& path) {
  LoadedConfig loaded = load_config_with_warnings(path);
  config_ = std::move(loaded.config);
  return std::move(loaded.warnings);
}

EffectiveConfig RigFile::effective() const {
  return {effective_config(config_), config_hash(config_)};
}

}  // namespace orchard::io
