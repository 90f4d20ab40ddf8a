// SPDX-License-Identifier: BSD-3-Clause
// Calibrates a simulated rig from pixels and scans over many seeds and prints the figures of
// tests/experiments/calibration_figures.sh: laser_camera_seeds FIRST LAST VIEWS SCANS [edges]
// With SQUARE the board's squares are stated as that many times their true side: such seeds must be
// refused, and the true size named.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include "calibration/extrinsics/laser_camera_calibration.hpp"
#include "experiments/laser_camera_views.hpp"
#include "geometry/camera_model.hpp"
#include "io/config/config.hpp"

namespace {

using namespace orchard;

constexpr double kDeg = 3.14159265358979323846 / 180.0;

struct Sums {
  int num = 0, refused = 0, inside = 0;
  double turn2 = 0.0, shift2 = 0.0, nees = 0.0, worst_turn = 0.0, worst_shift = 0.0;
  double turn_sd2 = 0.0, shift_sd2 = 0.0;
};

void add(const calibration::LaserCameraCalibration& result,
         const geometry::LaserCameraExtrinsics& truth, Sums& sums) {
  const geometry::LaserToCamera T(truth);
  const Eigen::AngleAxisd turn(T.rotation() * result.mount.R_camera_laser.transpose());
  Eigen::Matrix<double, 6, 1> error;
  error << T.translation_m() - result.mount.delta_m, turn.angle() * turn.axis();
  ++sums.num;
  sums.turn2 += error.tail<3>().squaredNorm();
  sums.shift2 += error.head<3>().squaredNorm();
  sums.turn_sd2 += result.covariance.bottomRightCorner<3, 3>().trace();
  sums.shift_sd2 += result.covariance.topLeftCorner<3, 3>().trace();
  sums.worst_turn = std::max(sums.worst_turn, error.tail<3>().norm());
  sums.worst_shift = std::max(sums.worst_shift, error.head<3>().norm());
  sums.nees += error.dot(result.covariance.ldlt().solve(error));
  for (int i = 0; i < 6; ++i) {
    const double half = result.interval95_factor * std::sqrt(result.covariance(i, i));
    if (std::abs(error[i]) <= half) ++sums.inside;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr,
                 "usage: %s FIRST LAST VIEWS SCANS [edges|no-edges] [HANDLING [CORNER_NOISE_PX|- "
                 "[SQUARE]]]\n",
                 argv[0]);
    return 2;
  }
  const int first = std::atoi(argv[1]), last = std::atoi(argv[2]);
  const int num_views = std::atoi(argv[3]), num_scans = std::atoi(argv[4]);
  const bool edges = argc > 5 && std::string(argv[5]) == "edges";
  const io::Config config = io::load_config(ORCHARD_SOURCE_DIR "/config/tubes.yaml");
  simulation::RigConfig rig{config.laser, config.camera, config.simulation, {}};
  rig.simulation.board.num_poses = num_views;
  if (argc > 6)
    rig.simulation.board.handling = static_cast<simulation::BoardHandling>(std::atoi(argv[6]));
  std::optional<double> corner_noise_px;
  if (argc > 7 && std::string(argv[7]) != "-") corner_noise_px = std::atof(argv[7]);
  const double stated_of_true = argc > 8 ? std::atof(argv[8]) : 1.0;
  int num_named = 0;
  double worst_named = 0.0;
  Sums sums;
  for (int seed = first; seed <= last; ++seed) {
    const auto views = calibration_test::views_of_scene(
        static_cast<std::uint64_t>(seed), rig, num_scans, corner_noise_px, stated_of_true, edges);
    calibration::LaserCameraOptions options = calibration::laser_camera_options(rig.laser);
    options.use_edges = edges;
    const auto result = calibration::calibrate_laser_camera(views.views, views.outline, options);
    if (!result.refusal.empty()) {
      ++sums.refused;
      if (result.board_scale > 0.0) {
        ++num_named;
        worst_named = std::max(worst_named, std::abs(result.board_scale * stated_of_true - 1.0));
      }
      std::printf("seed %d: refused: %s\n", seed, result.refusal.c_str());
      continue;
    }
    add(result, rig.camera.extrinsics, sums);
    std::fprintf(stderr, "seed %d: %d of %zu views, rms %.1f mm\n", seed, result.num_used,
                 views.views.size(), 1e3 * result.rms_m);
  }
  const double n = std::max(1, sums.num);
  std::printf("seeds %d-%d, %d views of %d scan(s), %s: %d calibrated, %d refused\n", first, last,
              num_views, num_scans, edges ? "with edges" : "no edges", sums.num, sums.refused);
  if (stated_of_true != 1.0) {
    std::printf(
        "  squares stated as %.2f of their side: of %d refused %d name the size, off by %.2f %%\n",
        stated_of_true, sums.refused, num_named, 100.0 * worst_named);
  }
  std::printf("  rotation     RMS %.3f deg (stated %.3f), worst %.3f\n",
              std::sqrt(sums.turn2 / n) / kDeg, std::sqrt(sums.turn_sd2 / n) / kDeg,
              sums.worst_turn / kDeg);
  std::printf("  translation  RMS %.2f mm (stated %.2f), worst %.2f\n",
              1e3 * std::sqrt(sums.shift2 / n), 1e3 * std::sqrt(sums.shift_sd2 / n),
              1e3 * sums.worst_shift);
  std::printf("  95 %% intervals hold the truth in %.1f %% (%d of %d); NEES %.2f (6 wanted)\n",
              100.0 * sums.inside / (6.0 * n), sums.inside, 6 * sums.num, sums.nees / n);
  return 0;
}
