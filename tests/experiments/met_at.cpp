// SPDX-License-Identifier: BSD-3-Clause
// What the beams of a simulated drive through an orchard met within 0.15 m of given places in map,
// by the simulated world itself and without noise: a tree, another thing of the truth, a low
// branch, grass, the ground. A line of JSON per place, with the number of beams that met each.
//   met_at RIG SEED [X_M Y_M]...
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "experiments/json_line.hpp"
#include "io/config/config.hpp"
#include "simulation/random.hpp"
#include "simulation/sensor/ground_ray.hpp"
#include "simulation/simulator.hpp"

namespace {

using namespace orchard::simulation;

constexpr double kNear_m = 0.15;    // derived: half of the gate of extra landmarks
constexpr double kBlade_m = 0.005;  // derived: what is met higher above the ground is grass

constexpr std::uint64_t kEvery = 10;  // derived: a sweep a metre

enum Kind { kTree, kObject, kBranch, kGrass, kGround };

struct Place {
  Eigen::Vector2d p_map;
  std::array<int, 5> num_met{};
};

/// Counts what the beams of one sweep meet, the robot held where it is at the first beam.
void sweep_past(const Scene& scene, const WheeledBody& body, const RigConfig& rig,
                const TruePose& pose, std::uint64_t bits, std::vector<Place>& places) {
  const ScannerConfig& scanner = rig.simulation.scanner;
  const TerrainConfig& ground = rig.simulation.terrain;
  const Pose3 T_base_laser{{rig.laser.mount_x_m, rig.laser.mount_y_m, rig.laser.mount_yaw_rad},
                           scanner.height_m,
                           ground.laser_pitch_rad,
                           ground.laser_roll_rad};
  const Pose3 T_map_base{
      {pose.x_m, pose.y_m, pose.yaw_rad}, pose.z_m, pose.pitch_rad, pose.roll_rad};
  const Eigen::Isometry3d T_map_laser = T_map_base.transform() * T_base_laser.transform();
  const UnevenSweep sweep{body.terrain(), ground.grass_height_m, {T_map_laser}};
  RayFan fan(sweep, scanner, 1, bits);
  fan.add(scene.world);
  const auto is_tree = [&scene](int target) {
    return scene.truth[static_cast<std::size_t>(target)].label == orchard::detection::Label::kTree;
  };
  for (int beam = 0; beam < scanner.num_beams; ++beam) {
    const double bearing_rad = scanner.bearing_min_rad + beam * scanner.bearing_step_rad;
    const Eigen::Vector3d towards =
        T_map_laser.linear() * Eigen::Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
    const Eigen::Vector3d from = T_map_laser.translation();
    const Hit above = *fan.beam(beam);
    const std::uint64_t blades = mix_bits(bits ^ static_cast<std::uint64_t>(beam));
    const Hit below = meet_ground(body.terrain(), ground.grass_height_m, from, towards,
                                  std::min(above.range_m, scanner.range_max_m),
                                  static_cast<double>((blades >> 11) + 1) * 0x1p-53);
    const double range_m = std::min(above.range_m, below.range_m);
    if (range_m > scanner.range_max_m) continue;
    const Eigen::Vector3d met = from + range_m * towards;
    const bool is_blade = met.z() - body.terrain().height_m(met.x(), met.y()) > kBlade_m;
    const Kind kind = below.range_m < above.range_m ? (is_blade ? kGrass : kGround)
                      : above.target < 0            ? kBranch
                      : is_tree(above.target)       ? kTree
                                                    : kObject;
    for (Place& place : places) {
      place.num_met[kind] += (met.head<2>() - place.p_map).norm() < kNear_m ? 1 : 0;
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) {
    std::fprintf(stderr, "usage: met_at RIG SEED [X_M Y_M]...\n");
    return 2;
  }
  const orchard::io::Config config = orchard::io::load_config(argv[1]);
  const std::uint64_t seed = std::strtoull(argv[2], nullptr, 10);
  const RigConfig rig{config.laser, config.camera, config.simulation, config.laser_rear};
  std::vector<Place> places;
  for (int i = 3; i + 1 < argc; i += 2) {
    places.push_back({{std::atof(argv[i]), std::atof(argv[i + 1])}});
  }
  const Simulator simulator(SceneKind::kOrchard, seed, rig);
  const Terrain terrain(seed, rig.simulation.terrain);
  const WheeledBody body(terrain, rig.simulation.terrain);
  std::uint64_t sweep = 0;
  for (const TruePose& pose : simulator.true_poses()) {
    if (++sweep % kEvery != 0) continue;
    sweep_past(simulator.scene(), body, rig, pose, mix_bits(sweep), places);
  }
  for (const Place& place : places) {
    orchard::trials::print_json({{"x_m", place.p_map.x()},
                                 {"y_m", place.p_map.y()},
                                 {"tree", place.num_met[kTree]},
                                 {"object", place.num_met[kObject]},
                                 {"branch", place.num_met[kBranch]},
                                 {"grass", place.num_met[kGrass]},
                                 {"ground", place.num_met[kGround]}});
  }
  return 0;
}
