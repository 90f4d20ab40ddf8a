// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "detection/detector_config.hpp"
#include "geometry/camera_config.hpp"
#include "laser/laser_config.hpp"
#include "mapping/mapper_config.hpp"
#include "pose/pose_config.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::io {

/// Where the messages go. Section `lcm`.
struct LcmConfig {
  std::string url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";
};

template <class Visitor>
void describe(Visitor& v, LcmConfig& c) {
  v.text("url", c.url, "LCM provider; ttl=0 stays on this machine, ttl=1 reaches its network");
}

/// The whole configuration of a rig: one YAML file, read by every process.
struct Config {
  LcmConfig lcm;
  laser::LaserConfig laser;
  geometry::CameraConfig camera;
  detection::DetectorConfig detector;
  pose::PoseConfig pose;
  mapping::MapperConfig mapper;
  simulation::SimulationConfig simulation;
};

template <class Visitor>
void describe(Visitor& v, Config& c) {
  v.section("lcm", c.lcm, "messages");
  v.section("laser", c.laser, "laser mount and noise");
  v.section("camera", c.camera, "camera intrinsics and extrinsics");
  v.section("detector", c.detector, "scan and image to detections");
  v.section("pose", c.pose, "where the robot is");
  v.section("mapper", c.mapper, "detections to the map");
  v.section("simulation", c.simulation, "the simulated world and its sensors");
}

/// A configuration that was refused: one line per mistake, each "file:line: key = value: why".
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<std::string> problems);
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
};

/// Reads a rig's YAML over the defaults. Throws ConfigError naming every unknown key (with its
/// nearest neighbour), wrong type, value out of range and crossed limit at once; repairs nothing.
Config load_config(const std::string& path);

/// The same from text; `name` stands for the file in messages.
Config parse_config(const std::string& yaml, const std::string& name);

/// All keys with values, units, ranges and meanings, as YAML that load_config reads.
std::string print_config(const Config& config);

/// The effective configuration without comments: what CONFIG carries and the hash is of.
std::string effective_config(const Config& config);

/// FNV-1a of effective_config().
std::int64_t config_hash(const Config& config);

}  // namespace orchard::io
