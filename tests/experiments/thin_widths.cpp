// SPDX-License-Identifier: BSD-3-Clause
// How well the map knows the width of thin and thick trunks, near and far, through beams that are
// spots: bias, spread, the Cramer-Rao bound of counting beams, and what width_sd_m is worth.
// thin_widths TRUNKS FIRST.
#include <cmath>
#include <cstdlib>

#include "detection/detect.hpp"
#include "experiments/json_line.hpp"
#include "mapping/landmark_record.hpp"
#include "simulation/sensor/laser_model.hpp"

namespace {

using namespace orchard;

constexpr int kNumObservations = 30;
constexpr double kRangeSpread =
    0.15;  ///< the robot passes: observations are from this much nearer to farther

struct Row {
  int num = 0;
  double bias_m = 0.0, rms_m = 0.0, bound_m2 = 0.0, nees = 0.0;
};

/// What the spot adds to a width, exactly as the simulator casts its rays: a ninth of the spot is
/// as fine as it tells them apart.
double spot_m(const simulation::ScannerConfig& scanner, double range_m) {
  constexpr double kNumRays = 9.0;
  const double fewest = std::max(1.0, std::ceil(scanner.return_fraction * kNumRays));
  return (scanner.spot_m + scanner.spot_rad * range_m) * (1.0 - (2.0 * fewest - 1.0) / kNumRays);
}

/// One trunk, looked at from `kNumObservations` places.
bool trunk(double diameter_m, double range_m, const simulation::ScannerConfig& scanner, bool wall,
           const detection::Rig& rig, simulation::Random& random, Row& row) {
  mapping::LandmarkRecord record;
  double information = 0.0;
  for (int observation = 0; observation < kNumObservations; ++observation) {
    const double r_m = range_m * (1.0 + kRangeSpread * random.uniform(-1.0, 1.0));
    const double bearing_rad = random.uniform(-0.3, 0.3);
    const double d_m = r_m + 0.5 * diameter_m;
    simulation::World world;
    world.num_targets = 2;
    simulation::Cylinder c;
    c.x_m = d_m * std::cos(bearing_rad);
    c.y_m = d_m * std::sin(bearing_rad);
    c.radius_m = 0.5 * diameter_m;
    c.height_m = 2.0;
    c.appearance.reflectivity = 0.5;
    world.cylinders.push_back(c);
    if (wall) {
      simulation::Box box;
      box.x_m = (d_m + 1.5) * std::cos(bearing_rad);
      box.y_m = (d_m + 1.5) * std::sin(bearing_rad);
      box.yaw_rad = bearing_rad;
      box.length_m = 0.1;
      box.width_m = 6.0;
      box.height_m = 2.0;
      box.target = 1;
      world.boxes.push_back(box);
    }
    // a count of beams whose phase is not known, and the range that makes an angle a width
    const double step_m = d_m * scanner.bearing_step_rad;
    const double beams = std::max(1.0, diameter_m / step_m);
    const double of_beams_m = diameter_m * scanner.beam_sd_m / (r_m * std::sqrt(beams));
    const double of_target_m = diameter_m * scanner.scan_sd_fraction;
    information +=
        1.0 / (step_m * step_m / 6.0 + of_beams_m * of_beams_m + of_target_m * of_target_m);
    const auto scan = simulation::simulate_scan(world, {geometry::Pose2{}}, scanner, {}, random);
    for (const auto& d : detection::find_by_laser(scan, rig).detections.trunks) {
      if (std::hypot(d.centre_x_m - c.x_m, d.centre_y_m - c.y_m) > 0.2) continue;
      mapping::fuse_width(record, d, rig.detector.segmentation.min_beams);
      break;
    }
  }
  if (!(record.width_information > 0.0f)) return false;
  const double error_m = record.width_m - diameter_m, sd_m = mapping::width_sd_m(record);
  ++row.num;
  row.bias_m += error_m;
  row.rms_m += error_m * error_m;
  row.bound_m2 += 1.0 / information;
  row.nees += error_m * error_m / (sd_m * sd_m);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const int num_trunks = argc > 1 ? std::atoi(argv[1]) : 100;
  const int first_seed = argc > 2 ? std::atoi(argv[2]) : 1;
  struct Kind {
    double step_rad, beam_sd_m, spot_m, spot_rad;
  };
  for (const Kind& kind : {Kind{0.0043633, 0.008, 0.0, 0.0}, Kind{0.0043633, 0.008, 0.005, 0.0},
                           Kind{0.0043633, 0.008, 0.015, 0.0}, Kind{0.0043633, 0.008, 0.004, 0.004},
                           Kind{0.0061359, 0.003, 0.008, 0.002}}) {
    for (const bool wall : {false, true}) {
      for (const double diameter_m : {0.05, 0.07, 0.125, 0.25, 0.4}) {
        for (const double range_m : {0.6, 1.5, 3.0, 5.0, 8.5}) {
          simulation::ScannerConfig scanner;
          scanner.num_beams = static_cast<int>(1.6 / kind.step_rad);
          scanner.bearing_step_rad = kind.step_rad;
          scanner.bearing_min_rad = -0.5 * (scanner.num_beams - 1) * kind.step_rad;
          scanner.range_max_m = 30.0;
          scanner.beam_sd_m = kind.beam_sd_m;
          scanner.beam_sd_fraction = 0.0;
          scanner.spot_m = kind.spot_m;
          scanner.spot_rad = kind.spot_rad;
          scanner.return_fraction = 0.1;
          scanner.mixed_probability = wall ? 0.2 : 0.0;
          laser::LaserConfig laser;
          laser.range_sd_m = kind.beam_sd_m;
          laser.range_sd_fraction = 0.0;
          laser.target_sd_fraction = scanner.scan_sd_fraction;
          geometry::CameraConfig camera;
          camera.enabled = false;
          detection::DetectorConfig detector;
          detector.segmentation.range_max_m = 20.0;
          detector.segmentation.min_beams = 1;
          detector.width.mean_m = 0.12;
          detector.width.sd_m = 1.0;
          Row known, line;
          const detection::Rig as_line(laser, camera, detector);
          const double far_m = spot_m(scanner, 10.0), near_m = spot_m(scanner, 0.0);
          laser.spot_m = near_m;
          laser.spot_rad = 0.1 * (far_m - near_m);
          const detection::Rig as_spot(laser, camera, detector);
          for (int i = 0; i < num_trunks; ++i) {
            const auto seed = static_cast<std::uint64_t>(first_seed + i);
            simulation::Random a(seed), b(seed);
            trunk(diameter_m, range_m, scanner, wall, as_spot, a, known);
            trunk(diameter_m, range_m, scanner, wall, as_line, b, line);
          }
          if (known.num == 0) continue;
          const double n = known.num, bias_m = known.bias_m / n;
          const double sd_m = std::sqrt(std::max(0.0, known.rms_m / n - bias_m * bias_m));
          const double bound_m = std::sqrt(known.bound_m2 / n);
          trials::print_json(
              {{"step_rad", kind.step_rad},
               {"spot_m", kind.spot_m},
               {"spot_rad", kind.spot_rad},
               {"wall", wall},
               {"diameter_m", diameter_m},
               {"range_m", range_m},
               {"bias_fraction", bias_m / diameter_m},
               {"sd_over_bound", sd_m / bound_m},
               {"nees", known.nees / n},
               {"line_bias_fraction", line.bias_m / std::max(1, line.num) / diameter_m}});
        }
      }
    }
  }
}
