// SPDX-License-Identifier: BSD-3-Clause
// Are thin poles with reflectors found, whatever stands close behind them? 15 poles of 70 mm in two
// rows, a board or a bush 4 to 15 cm behind each, reflectors that bloom and flash in most
// observations; `reflector: only` and no other key. beacons SEEDS FIRST.
#include <cmath>
#include <cstdlib>
#include <vector>

#include "detection/detect.hpp"
#include "experiments/json_line.hpp"
#include "mapping/mapper.hpp"
#include "simulation/sensor/laser_model.hpp"

namespace {

using namespace orchard;

constexpr int kNumPoles = 15;
constexpr double kDiameter_m = 0.07;
constexpr double kDark =
    0.2;  ///< fraction of observations in which a reflector is turned away or dirty

struct Result {
  int found = 0, extra = 0, objects = 0;
  double rms_m = 0.0;
};

Result run(std::uint64_t seed) {
  simulation::Random random(seed);
  simulation::ScannerConfig scanner;
  scanner.intensities = true;
  scanner.bloom_rad = 0.0065;
  scanner.spot_m = 0.005;
  scanner.return_fraction = 0.2;
  simulation::World world;
  std::vector<geometry::Pose2> truth;
  for (int i = 0; i < kNumPoles; ++i) {
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const double x_m = 2.0 + 1.4 * i + random.uniform(-0.3, 0.3);
    const double y_m = side * random.uniform(1.2, 3.0);
    simulation::Cylinder pole;
    pole.x_m = x_m;
    pole.y_m = y_m;
    pole.radius_m = 0.5 * kDiameter_m;
    pole.height_m = 2.0;
    pole.target = world.num_targets++;
    pole.appearance.reflectivity = 8.0;
    world.cylinders.push_back(pole);
    truth.push_back({x_m, y_m, 0.0});
    const double behind_m = random.uniform(0.04, 0.15);
    if (i % 3 == 0) {
      simulation::Cylinder bush;
      bush.radius_m = 0.25;
      bush.x_m = x_m + random.uniform(-0.1, 0.1);
      bush.y_m = y_m + side * (0.25 + behind_m);
      bush.height_m = 1.0;
      bush.target = world.num_targets++;
      world.cylinders.push_back(bush);
    } else if (i % 3 == 1) {
      simulation::Box board;
      board.x_m = x_m;
      board.y_m = y_m + side * behind_m;
      board.length_m = random.uniform(0.3, 0.8);
      board.width_m = 0.05;
      board.height_m = 1.0;
      board.target = world.num_targets++;
      world.boxes.push_back(board);
    }
  }
  laser::LaserConfig laser;
  geometry::CameraConfig camera;
  camera.enabled = false;
  detection::DetectorConfig detector;
  detector.segmentation.reflector = laser::ReflectorUse::kOnly;
  detector.segmentation.reflectivity_min = 1500.0;
  const detection::Rig rig(laser, camera, detector);
  mapping::MapperConfig config;
  config.min_beams = detector.segmentation.min_beams;
  config.reflector_marks_tree = true;
  mapping::Mapper mapper(config);
  for (int scan_index = 0; scan_index < 240; ++scan_index) {
    const double x_m = 0.1 * scan_index;
    simulation::World now = world;
    for (auto& c : now.cylinders) {
      if (c.appearance.reflectivity > 1.0 && random.uniform() < kDark)
        c.appearance.reflectivity = 0.4;
    }
    auto scan =
        simulation::simulate_scan(now, {geometry::Pose2{x_m, 0.0, 0.0}}, scanner, {}, random);
    scan.utime = 100000 * (scan_index + 1);
    const auto found = detection::find_by_laser(scan, rig).detections;
    pose::PoseEstimate pose;
    pose.utime = scan.utime;
    pose.x_m = x_m;
    mapper.update(found, pose);
  }
  Result result;
  std::vector<bool> taken(truth.size());
  for (const mapping::Landmark& l : mapper.landmarks()) {
    if (l.label != detection::Label::kTree) {
      ++result.objects;
      continue;
    }
    bool is_pole = false;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const double off_m = std::hypot(l.x_m - truth[i].x_m, l.y_m - truth[i].y_m);
      if (taken[i] || off_m > 0.05) continue;
      taken[i] = is_pole = true;
      result.rms_m += off_m * off_m;
      break;
    }
    ++(is_pole ? result.found : result.extra);
  }
  result.rms_m = std::sqrt(result.rms_m / std::max(1, result.found));
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  const int num_seeds = argc > 1 ? std::atoi(argv[1]) : 20;
  const int first_seed = argc > 2 ? std::atoi(argv[2]) : 1;
  for (int seed = first_seed; seed < first_seed + num_seeds; ++seed) {
    const Result r = run(static_cast<std::uint64_t>(seed));
    trials::print_json({{"seed", seed},
                        {"found", r.found},
                        {"rms_mm", 1e3 * r.rms_m},
                        {"extra", r.extra},
                        {"objects", r.objects}});
  }
}
