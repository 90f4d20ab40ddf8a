// SPDX-License-Identifier: BSD-3-Clause
// laser_camera_seeds FIRST LAST VIEWS edges|no-edges [STATED]: calibrates laser to camera from a
// simulated board, once a seed, its squares stated as STATED of what they are (1), and compares
// with the truth.
#include <string>
#include <vector>

#include "calibration/extrinsics/laser_camera_calibration.hpp"
#include "experiments/json_line.hpp"
#include "io/config/config.hpp"
#include "simulation/board_scene.hpp"

namespace {

using namespace orchard;

/// What the calibration is given of a simulated board: found in pixels, lines found in scans.
struct SceneViews {
  std::vector<calibration::ExtrinsicsView> views;
  calibration::BoardOutline outline;
};

/// One picture and one scan of each pose. The outline, which a person measures by itself, is given
/// as it is.
SceneViews views_of_scene(std::uint64_t seed, const simulation::RigConfig& rig,
                          double stated_of_true, bool outline_measured) {
  const simulation::BoardScene scene(seed, rig);
  SceneViews out;
  calibration::BoardConfig stated = scene.board();
  stated.square_m *= stated_of_true;
  out.outline = calibration::outline_of(stated);
  if (outline_measured) {
    const auto sheet = calibration::outline_of(scene.board());
    const double x_m = 0.5 * (out.outline.x_min_m + out.outline.x_max_m);
    const double y_m = 0.5 * (out.outline.y_min_m + out.outline.y_max_m);
    const double half_x_m = 0.5 * (sheet.x_max_m - sheet.x_min_m);
    const double half_y_m = 0.5 * (sheet.y_max_m - sheet.y_min_m);
    out.outline = {x_m - half_x_m, y_m - half_y_m, x_m + half_x_m, y_m + half_y_m};
  }
  std::vector<calibration::BoardView> boards;
  std::vector<laser::Scan> scans;
  for (std::size_t i = 0; i < scene.poses().size(); ++i) {
    const auto board = calibration::find_board(scene.picture(scene.poses()[i], i), stated);
    if (!board) continue;
    boards.push_back(*board);
    scans.push_back(scene.scan(scene.poses()[i], 1000 * i));
  }
  const auto search = calibration::line_search(out.outline, rig.laser);
  const auto poses =
      calibration::estimate_board_poses(boards, geometry::CameraModel(rig.camera.intrinsics));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!poses[i] || poses[i]->ambiguous) continue;
    calibration::ExtrinsicsView view;
    view.board = *poses[i];
    view.num_scans = 1;
    view.lines = calibration::find_board_lines(calibration::mean_scan({scans[i]}), search);
    out.views.push_back(view);
  }
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) {
    std::fprintf(stderr, "usage: laser_camera_seeds FIRST LAST VIEWS edges|no-edges [STATED]\n");
    return 2;
  }
  const bool edges = std::string(argv[4]) == "edges";
  const double stated_of_true = argc > 5 ? std::atof(argv[5]) : 1.0;
  const io::Config config = io::load_config(ORCHARD_SOURCE_DIR "/config/tubes.yaml");
  simulation::RigConfig rig{config.laser, config.camera, config.simulation, {}};
  rig.simulation.board.num_poses = std::atoi(argv[3]);
  const geometry::LaserToCamera truth(rig.camera.extrinsics);
  calibration::LaserCameraOptions options = calibration::laser_camera_options(rig.laser);
  options.use_edges = edges;
  for (int seed = std::atoi(argv[1]); seed <= std::atoi(argv[2]); ++seed) {
    const auto views = views_of_scene(static_cast<std::uint64_t>(seed), rig, stated_of_true, edges);
    const auto found = calibration::calibrate_laser_camera(views.views, views.outline, options);
    const bool is_refused = !found.refusal.empty();
    Eigen::Matrix<double, 6, 1> error = Eigen::Matrix<double, 6, 1>::Zero();
    if (!is_refused) {
      const Eigen::AngleAxisd turn(truth.rotation() * found.mount.R_camera_laser.transpose());
      error << truth.translation_m() - found.mount.delta_m, turn.angle() * turn.axis();
    }
    orchard::trials::print_json(
        {{"seed", seed},
         {"stated_of_true", stated_of_true},
         {"refused", is_refused},
         {"board_scale", found.board_scale},
         {"shift_m", error.head<3>().norm()},
         {"turn_rad", error.tail<3>().norm()},
         {"nees", is_refused ? 0.0 : error.dot(found.covariance.ldlt().solve(error))}});
  }
  return 0;
}
