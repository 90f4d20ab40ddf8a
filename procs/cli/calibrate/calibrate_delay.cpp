// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate.hpp"

#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>

#include "bus/process/process.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "cli/calibrate/delay_collector.hpp"
#include "geometry/angles.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

/// A better delay changes the pairing of pictures and shortens the interval bridged by odometry:
/// repeat until the delay converges.
constexpr int kMaxRounds = 6;
constexpr double kSettled_s = 0.0005;
/// A camera rotation above this is reported: the extrinsics need a calibration.
constexpr double kOffsetWorthTelling_deg = 0.3;

struct Round {
  std::vector<calibration::DelayObservation> observations;
  int num_pairs = 0;
  int num_moving = 0;
};

Round observe_logs(const CalibrateDelayOptions& options, const io::Config& config,
                   std::set<std::string>& warnings) {
  Round round;
  std::int32_t next_picture = 0;
  for (const std::string& path : options.log_paths) {
    DelayCollector collector(config, next_picture);
    replay_log("orchard calibrate delay", path, {&collector}, options.quiet, warnings);
    round.observations.insert(round.observations.end(), collector.observations().begin(),
                              collector.observations().end());
    round.num_pairs += collector.num_pairs();
    round.num_moving += collector.num_moving();
    next_picture = collector.next_picture();
  }
  const std::string& name = options.log_paths.front();
  if (round.num_pairs == 0) {
    throw io::FileError(name +
                        " has no scan with a picture of the same time; the delay of the camera is "
                        "measured from such pairs (see `orchard log info`)");
  }
  if (round.num_moving == 0) {
    throw io::FileError(name +
                        " has no ODOMETRY at the times of its pictures; it is needed for the "
                        "rotation of the robot (see `orchard log info`)");
  }
  return round;
}

double degrees(double offset_px, const io::Config& config) {
  return std::atan(offset_px / config.camera.intrinsics.fc_px[0]) * 180.0 / geometry::kPi;
}

void print(const calibration::DelayEstimate& e, double delay_s, const io::Config& config) {
  std::printf(
      "observations      %d of trunks in %d pictures, %d while turning (%d more rejected)\n",
      e.num_observations, e.num_pictures, e.num_turning, e.num_all - e.num_observations);
  std::printf("delay             %.1f ms, standard error %.1f ms\n", 1e3 * delay_s, 1e3 * e.se_s);
  std::printf(
      "constant offset   %.2f px (%.2f deg) between laser and image, standard error %.2f px\n",
      e.offset_px, degrees(e.offset_px, config), e.offset_se_px);
  std::printf("residual          %.2f px\n", e.residual_sd_px);
}

}  // namespace

int run_calibrate_delay(const CalibrateDelayOptions& options) {
  io::Config config = io::load_config(options.config_path);
  if (options.log_paths.empty())
    throw io::FileError("no input: give the logs of drives with curves past trunks");
  if (!config.camera.enabled) {
    throw io::FileError(
        options.config_path +
        " has camera.enabled: false; set it to true to calibrate the delay of a camera");
  }
  calibration::DelayEstimate estimate;
  std::set<std::string> warnings;
  try {
    for (int round = 0; round < kMaxRounds; ++round) {
      estimate =
          calibration::estimate_delay(observe_logs(options, config, warnings).observations, {});
      config.camera.delay_s += estimate.delay_s;
      if (std::abs(config.camera.delay_s) > 0.5) {
        throw std::runtime_error(
            "the estimated delay, " + fixed_text(config.camera.delay_s, 3) +
            " s, exceeds 0.5 s; check whether camera and laser use the same clock");
      }
      if (std::abs(estimate.delay_s) < kSettled_s) break;
    }
  } catch (const io::FileError&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw io::FileError(options.log_paths.front() + ": " + error.what());
  }
  if (!options.quiet) print(estimate, config.camera.delay_s, config);
  if (std::abs(degrees(estimate.offset_px, config)) > kOffsetWorthTelling_deg) {
    std::fprintf(
        stderr,
        "orchard calibrate delay: warning: image and laser edges differ by a constant %.1f px "
        "(%.2f deg); calibrate the extrinsics with `orchard calibrate laser-camera`\n",
        estimate.offset_px, degrees(estimate.offset_px, config));
  }

  const std::string note = "standard error " + fixed_text(1e3 * estimate.se_s, 1) + " ms, " +
                           std::to_string(estimate.num_observations) + " observations in " +
                           logs_text(options.log_paths);
  write_rig(options.config_path, options.out_path,
            {{"camera.delay_s", fixed_text(config.camera.delay_s, 4)}}, "orchard calibrate delay",
            note, options.quiet);
  return bus::kExitOk;
}

}  // namespace orchard::cli
