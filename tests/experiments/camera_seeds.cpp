// SPDX-License-Identifier: BSD-3-Clause
// camera_seeds FIRST LAST: calibrates a simulated camera from 25 pictures of a
// board, once a seed, and compares with the lens that took them.
#include <cmath>
#include <string>
#include <vector>

#include "calibration/board/camera_calibration.hpp"
#include "experiments/json_line.hpp"
#include "io/config/config.hpp"
#include "simulation/board_scene.hpp"
#include "worlds/board_motion.hpp"

namespace {

using namespace orchard;

constexpr int kNumViews = 25;

void run(const geometry::CameraIntrinsics& lens, int first, int last) {
  calibration::BoardConfig board;  // 8 x 6 inner corners of 30 mm
  const simulation::BoardPainter painter(lens, board);
  for (int seed = first; seed <= last; ++seed) {
    simulation::Random random(static_cast<std::uint64_t>(seed), simulation::Stream::kImage);
    std::vector<calibration::NamedView> views;
    for (const auto& T : simulation::show_board(lens, board, kNumViews, {}, random)) {
      const auto view = calibration::find_board(painter.take(T, random), board);
      if (view) views.push_back({"view " + std::to_string(views.size()), *view});
    }
    const auto found = calibration::calibrate_camera(views, lens.width_px, lens.height_px);
    std::vector<double> focal, centre_px;
    for (std::size_t i = 0; i < 2; ++i) {
      focal.push_back(std::abs(found.intrinsics.fc_px[i] / lens.fc_px[i] - 1.0));
      centre_px.push_back(std::abs(found.intrinsics.cc_px[i] - lens.cc_px[i]));
    }
    trials::print_json({{"seed", seed},
                        {"found", views.size()},
                        {"refused", !calibration::rejection_reasons(found).empty()},
                        {"rms_px", found.rms_px},
                        {"focal_error", focal},
                        {"centre_error_px", centre_px}});
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: camera_seeds FIRST LAST\n");
    return 2;
  }
  run(io::load_config(ORCHARD_SOURCE_DIR "/config/tubes.yaml").camera.intrinsics,
      std::atoi(argv[1]), std::atoi(argv[2]));
  return 0;
}
