// SPDX-License-Identifier: BSD-3-Clause
// camera_seeds FIRST LAST [VIEWS]: calibrates a simulated camera from pictures of a board, once
// per seed and kind of board, and compares with the lens that took them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "calibration/board/camera_acceptance.hpp"
#include "io/config/config.hpp"
#include "simulation/scene/board_picture.hpp"
#include "worlds/board_motion.hpp"

namespace {

using namespace orchard;

/// Errors of many calibrations against the truth, and how well they were foretold.
struct Figure {
  double largest = 0.0;
  double sum2 = 0.0;
  int count = 0;
  int inside = 0;  ///< of the stated 95 % intervals

  void add(double error, double sd, double unit) {
    largest = std::max(largest, std::abs(error) * unit);
    sum2 += error * error * unit * unit;
    ++count;
    inside += std::abs(error) <= 1.96 * sd;
  }
  double rms() const { return std::sqrt(sum2 / count); }
  double fraction() const { return 100.0 * inside / count; }
};

calibration::BoardConfig board_of(bool charuco) {
  calibration::BoardConfig board;  // 8 x 6 inner corners of 30 mm
  if (charuco) {
    board.kind = calibration::BoardConfig::kCharuco;
    board.columns = 7;
    board.rows = 6;
    board.square_m = 0.04;
    board.marker_m = 0.03;
  }
  return board;
}

void run(const geometry::CameraIntrinsics& lens, bool charuco, int first, int last, int num_views) {
  const calibration::BoardConfig board = board_of(charuco);
  const simulation::BoardPainter painter(lens, board);
  simulation::BoardMotionConfig motion;
  if (charuco) {  // as its parts suffice, it is held nearer
    motion.whole_board = false;
    motion.size_min = 0.45;
    motion.size_max = 0.9;
  }
  Figure focal, centre, distortion;
  int num_found = 0, num_shown = 0, num_refused = 0;
  double rms_px = 0.0;
  std::string first_reason;
  for (int seed = first; seed <= last; ++seed) {
    simulation::Random random(static_cast<std::uint64_t>(seed), simulation::Stream::kImage);
    std::vector<calibration::NamedView> views;
    for (const Eigen::Isometry3d& T_camera_board :
         simulation::show_board(lens, board, num_views, motion, random)) {
      ++num_shown;
      const auto view = calibration::find_board(painter.take(T_camera_board, random), board);
      if (view) views.push_back({"view " + std::to_string(num_shown), *view});
    }
    num_found += static_cast<int>(views.size());
    const auto result = calibration::calibrate_camera(views, lens.width_px, lens.height_px);
    const std::vector<std::string> reasons = calibration::rejection_reasons(result);
    num_refused += !reasons.empty();
    if (!reasons.empty() && first_reason.empty()) first_reason = reasons.front();
    rms_px += result.rms_px / (last - first + 1);
    for (std::size_t i = 0; i < 2; ++i) {
      focal.add(result.intrinsics.fc_px[i] - lens.fc_px[i], result.fc_sd_px[i],
                100.0 / lens.fc_px[i]);
      centre.add(result.intrinsics.cc_px[i] - lens.cc_px[i], result.cc_sd_px[i], 1.0);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      distortion.add(result.intrinsics.kc[i] - lens.kc[i], result.kc_sd[i], 1.0);
    }
  }
  std::printf(
      "%s, %d pictures per seed, seeds %d-%d: board found in %d of %d, rms %.3f px, %d of %d "
      "results refused by the verdict\n",
      charuco ? "ChArUco 7 x 6" : "chessboard 8 x 6", num_views, first, last, num_found, num_shown,
      rms_px, num_refused, last - first + 1);
  if (!first_reason.empty()) std::printf("  the first for: %s\n", first_reason.c_str());
  const auto print = [](const char* what, const Figure& figure, const char* limit) {
    std::printf(
        "  %-22s max %8.4f  rms %8.4f  wanted at most %-6s  in its 95 %% interval: %5.1f %%\n",
        what, figure.largest, figure.rms(), limit, figure.fraction());
  };
  print("focal length error %", focal, "0.5");
  print("principal point px", centre, "1.5");
  print("k1 k2 p1 p2", distortion, "-");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: camera_seeds FIRST LAST [VIEWS]\n");
    return 2;
  }
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const int first = std::atoi(argv[1]), last = std::atoi(argv[2]);
  const int num_views = argc > 3 ? std::atoi(argv[3]) : 25;
  const auto lens =
      io::load_config(ORCHARD_SOURCE_DIR "/config/tubes.yaml").camera.intrinsics;  // 320 x 240
  std::printf("camera: synthetic pictures of %d x %d with noise, blur, uneven light and clutter\n",
              lens.width_px, lens.height_px);
  run(lens, false, first, last, num_views);
  run(lens, true, first, last, num_views);
  return 0;
}
