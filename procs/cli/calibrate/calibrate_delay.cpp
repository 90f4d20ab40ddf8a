// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate.hpp"

#include <cmath>
#include <cstdio>
#include <optional>
#include <set>

#include "bus/process/process.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "cli/calibrate/delay_collector.hpp"
#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "pose/rig/rig_monitor.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

/// A better delay changes the pairing of pictures and shortens the interval bridged by odometry:
/// repeat until the delay converges.
constexpr int kMaxRounds = 6;
constexpr double kSettled_s = 0.0005;
/// derived: at 0.5 rad/s the error of an object at 10 m is then as large as that of a range.
constexpr double kMaxLaserSd_s = 0.02;
/// A camera rotation above this is reported: the extrinsics need a calibration.
constexpr double kOffsetWorthTelling_deg = 0.3;

std::vector<calibration::DelayObservation> observe_logs(const CalibrateDelayOptions& options,
                                                        const io::Config& config,
                                                        std::set<std::string>& warnings) {
  std::vector<calibration::DelayObservation> observations;
  int num_pairs = 0, num_moving = 0;
  std::int32_t next_picture = 0;
  for (const std::string& path : options.log_paths) {
    DelayCollector collector(config, next_picture);
    replay_log("orchard calibrate delay", path, {&collector}, options.quiet, warnings);
    observations.insert(observations.end(), collector.observations().begin(),
                        collector.observations().end());
    num_pairs += collector.num_pairs();
    num_moving += collector.num_moving();
    next_picture = collector.next_picture();
  }
  const std::string& name = options.log_paths.front();
  if (num_pairs == 0) {
    throw io::FileError(name +
                        " has no scan with a picture of the same time; the delay of the camera is "
                        "measured from such pairs (see `orchard log info`)");
  }
  if (num_moving == 0) {
    throw io::FileError(name +
                        " has no ODOMETRY at the times of its pictures; it is needed for the "
                        "rotation of the robot (see `orchard log info`)");
  }
  return observations;
}

/// Compares the motion of a log's scans with its wheels'; sends nothing.
class TurnCollector : public bus::Node {
 public:
  explicit TurnCollector(const io::Config& config)
      : monitor_({config.laser, config.laser_rear, config.detector.segmentation.blind_sector(),
                  config.pose.scan_motion, config.pose.gnss}) {}

  std::string_view name() const override { return "calibration"; }
  std::vector<bus::Channel> inputs() const override {
    return {bus::Channel::kScan, bus::Channel::kScanRear, bus::Channel::kOdometry};
  }
  void handle(const bus::Message& input, const bus::Outbox&) override {
    if (const auto* rear = std::get_if<laser::RearScan>(&input)) return monitor_.add_rear(*rear);
    if (const auto* scan = std::get_if<laser::Scan>(&input)) return monitor_.add(*scan);
    if (const auto* odometry = std::get_if<pose::Odometry>(&input)) monitor_.add(*odometry);
  }
  void flush(const bus::Outbox&) override { monitor_.finish(); }

  const pose::RigEstimates& estimates() const { return monitor_.estimates(); }

 private:
  pose::RigMonitor monitor_;
};

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

int measure_camera(const CalibrateDelayOptions& options, io::Config config) {
  calibration::DelayEstimate estimate;
  std::set<std::string> warnings;
  for (int round = 0; round < kMaxRounds; ++round) {
    const auto observations = observe_logs(options, config, warnings);
    estimate = naming(options.log_paths.front(),
                      [&] { return calibration::estimate_delay(observations, {}); });
    config.camera.delay_s += estimate.delay_s;
    if (std::abs(config.camera.delay_s) > 0.5) {
      throw io::FileError(options.log_paths.front() + ": the estimated delay, " +
                          fixed_text(config.camera.delay_s, 3) +
                          " s, exceeds 0.5 s; check whether camera and laser use the same clock");
    }
    if (std::abs(estimate.delay_s) < kSettled_s) break;
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

/// The delay of one scanner after the wheels, over all logs; none where no log tells it.
std::optional<pose::Estimate> mean(const std::vector<pose::MountEstimate>& found) {
  double weights = 0.0, sum = 0.0;
  for (const pose::MountEstimate& one : found) {
    const double weight = 1.0 / geometry::square(one.reference_lag_s.sd);
    weights += weight;
    sum -= weight * one.reference_lag_s.value;
  }
  if (weights <= 0.0) return std::nullopt;
  return pose::Estimate{sum / weights, std::sqrt(1.0 / weights)};
}

int measure_laser(const CalibrateDelayOptions& options, const io::Config& config) {
  std::vector<pose::MountEstimate> front, rear;
  std::set<std::string> warnings;
  for (const std::string& path : options.log_paths) {
    TurnCollector collector(config);
    replay_log("orchard calibrate delay", path, {&collector}, options.quiet, warnings);
    const pose::RigEstimates& seen = collector.estimates();
    if (seen.laser && seen.by_wheels) front.push_back(*seen.laser);
    if (seen.laser_rear && seen.by_wheels) rear.push_back(*seen.laser_rear);
  }
  std::vector<io::ConfigValue> values;
  std::string note;
  const auto take = [&](const std::string& section, const std::vector<pose::MountEstimate>& found,
                        double present_s) {
    const auto delay_s = mean(found);
    if (!delay_s || delay_s->sd > kMaxLaserSd_s) return;
    const std::string text = fixed_text(1e3 * delay_s->value, 1) +
                             " ms after ODOMETRY, standard error " +
                             fixed_text(1e3 * delay_s->sd, 1) + " ms";
    if (!options.quiet) std::printf("%-17s %s\n", section.c_str(), text.c_str());
    values.push_back(
        {"drivers." + section + ".delay_s", fixed_text(present_s + delay_s->value, 3)});
    note += (note.empty() ? "" : "; ") + section + " " + text;
  };
  take("laser", front, config.drivers.laser.delay_s);
  if (config.laser_rear.enabled) take("laser_rear", rear, config.drivers.laser_rear.delay_s);
  if (values.empty()) {
    throw io::FileError(
        options.log_paths.front() +
        " does not tell the delay of the scans: it needs ODOMETRY and turns to both "
        "sides between things that stand still, for some hundred metres");
  }
  write_rig(options.config_path, options.out_path, values, "orchard calibrate delay",
            note + ", " + logs_text(options.log_paths), options.quiet);
  return bus::kExitOk;
}

}  // namespace

int run_calibrate_delay(const CalibrateDelayOptions& options) {
  const io::Config config = io::load_config(options.config_path);
  if (options.log_paths.empty())
    throw io::FileError("no input: give the logs of drives with curves past trunks");
  return config.camera.enabled && !options.of_laser ? measure_camera(options, config)
                                                    : measure_laser(options, config);
}

}  // namespace orchard::cli
