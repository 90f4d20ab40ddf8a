// SPDX-License-Identifier: BSD-3-Clause
// What a receiver that comes in bursts makes of the path, seed by seed: mode fused. Errors outside
// of gaps, and in each as a fraction of the way driven in it. And what a mapper makes of it, which
// corrects the poses told by each trajectory: its error, and by how much a step of it is too long.
#include <GeographicLib/LocalCartesian.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/LU>

#include "experiments/json_line.hpp"
#include "geometry/pose2.hpp"
#include "io/config/config.hpp"
#include "pose/filter/fusion.hpp"
#include "simulation/simulator.hpp"
#include "worlds/mapped_path.hpp"

namespace {

using namespace orchard;

constexpr double kGapMin_s = 15.0;

/// A fix is good where its error is one that its claim bears out.
constexpr double kGood_sigma = 3.0;

struct Gap {
  double begin_s, end_s, way_m;
};

struct Errors {
  double sum2 = 0.0, most_m = 0.0;
  int num = 0;
  void add(double error_m) {
    sum2 += error_m * error_m;
    most_m = std::max(most_m, error_m);
    ++num;
  }
  double rms_m() const { return num > 0 ? std::sqrt(sum2 / num) : 0.0; }
};

struct PathPoint {
  double time_s, x_m, y_m;
};

/// The mapper's path at the end, against the truth.
struct JudgedTrack {
  double rms_m = 0.0, excess_most_m = 0.0;
};

double seconds(std::int64_t utime) {
  return 1e-6 * static_cast<double>(utime - simulation::kEpochUtime);
}

double nees2(const pose::PoseEstimate& pose, const simulation::Pose2& truth) {
  const Eigen::Vector2d e(pose.x_m - truth.x_m, pose.y_m - truth.y_m);
  Eigen::Matrix2d P;
  P << pose.covariance[0], pose.covariance[1], pose.covariance[1], pose.covariance[3];
  return e.dot(P.inverse() * e);
}

/// Errors outside of gaps, and in each as a fraction of the way driven in it.
struct Judged {
  Errors outside, inside;
  double fraction_worst = 0.0;
  int num_fractions_good = 0;
};

Judged judge(const std::vector<PathPoint>& path, const std::vector<Gap>& gaps,
             const simulation::Scene& scene) {
  Judged judged;
  std::vector<Errors> in_gap(gaps.size());
  for (const PathPoint& p : path) {
    const simulation::Pose2 truth = scene.path.pose_at(p.time_s);
    const double error_m = std::hypot(p.x_m - truth.x_m, p.y_m - truth.y_m);
    const auto gap = std::find_if(gaps.begin(), gaps.end(), [&](const Gap& g) {
      return p.time_s > g.begin_s && p.time_s < g.end_s;
    });
    if (gap == gaps.end()) {
      judged.outside.add(error_m);
    } else {
      judged.inside.add(error_m);
      in_gap[static_cast<std::size_t>(gap - gaps.begin())].add(error_m);
    }
  }
  for (std::size_t i = 0; i < gaps.size(); ++i) {
    const double fraction = in_gap[i].rms_m() / std::max(gaps[i].way_m, 1.0);
    judged.fraction_worst = std::max(judged.fraction_worst, fraction);
    if (fraction <= 0.01) ++judged.num_fractions_good;
  }
  return judged;
}

JudgedTrack judge(const std::vector<pose::PoseEstimate>& path, const simulation::Scene& scene) {
  Errors errors;
  JudgedTrack judged;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const pose::PoseEstimate& b = path[i];
    const simulation::Pose2 true_b = scene.path.pose_at(seconds(b.utime));
    errors.add(std::hypot(b.x_m - true_b.x_m, b.y_m - true_b.y_m));
    if (i == 0) continue;
    const pose::PoseEstimate& a = path[i - 1];
    const simulation::Pose2 true_a = scene.path.pose_at(seconds(a.utime));
    judged.excess_most_m = std::max(
        judged.excess_most_m, std::hypot(b.x_m - a.x_m, b.y_m - a.y_m) -
                                  std::hypot(true_b.x_m - true_a.x_m, true_b.y_m - true_a.y_m));
  }
  judged.rms_m = errors.rms_m();
  return judged;
}

void run(const io::Config& config, simulation::SceneKind kind, unsigned long seed) {
  const simulation::RigConfig rig{config.laser, config.camera, config.simulation,
                                  config.laser_rear};
  simulation::Simulator simulator(kind, seed, rig);
  const simulation::ReceiverSky sky(seed, config.simulation.gnss.sky);
  pose::Fusion localiser(config.pose);
  const auto& datum = config.simulation.motion.datum;
  const GeographicLib::LocalCartesian enu(datum[0], datum[1], datum[2]);
  std::vector<PathPoint> live, smooth;
  MappedPath mapped(config.mapper.pose_gap_max_s);
  std::vector<Gap> gaps;
  double last_fix_s = 0.0, left_out_since_s = -1.0, left_out_most_s = 0.0;
  int num_fixes = 0, num_good_left_out = 0;
  double nees_live = 0.0, nees_smooth = 0.0;
  const auto add_gap = [&](double now_s) {
    if (now_s - last_fix_s < kGapMin_s) return;
    double way_m = 0.0;
    for (double t = last_fix_s; t < now_s; t += 0.5) {
      const auto a = simulator.scene().path.pose_at(t);
      const auto b = simulator.scene().path.pose_at(t + 0.5);
      way_m += std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
    }
    gaps.push_back({last_fix_s, now_s + 1e-3, way_m});
  };
  const auto use = [&](const std::optional<pose::Trajectory>& trajectory) {
    if (!trajectory) return;
    smooth.clear();
    for (const auto& p : trajectory->poses) smooth.push_back({seconds(p.utime), p.x_m, p.y_m});
    const auto& last = trajectory->poses.back();
    nees_smooth = nees2(last, simulator.scene().path.pose_at(seconds(last.utime)));
  };
  while (const auto message = simulator.next()) {
    if (const auto* odometry = std::get_if<pose::Odometry>(&*message)) {
      localiser.add(pose::Measurement(*odometry));
    } else if (const auto* gnss = std::get_if<pose::Gnss>(&*message)) {
      const double now_s = seconds(gnss->utime);
      const simulation::Pose2 truth = simulator.scene().path.pose_at(now_s);
      add_gap(now_s);
      last_fix_s = now_s;
      ++num_fixes;
      double x_m = 0.0, y_m = 0.0, z_m = 0.0;
      enu.Forward(gnss->latitude_deg, gnss->longitude_deg, gnss->altitude_m, x_m, y_m, z_m);
      localiser.add(pose::Measurement(*gnss));
      const auto& antenna = config.simulation.gnss.antenna_m;
      const simulation::Pose2 at = compose(truth, {antenna[0], antenna[1], 0.0});
      const bool good =
          std::hypot(x_m - at.x_m, y_m - at.y_m) < kGood_sigma * std::sqrt(gnss->covariance[0]) &&
          !sky.is_reflected(now_s);
      const bool taken = !localiser.is_displaced();
      if (taken || !good) {
        if (taken) left_out_since_s = -1.0;
      } else {
        ++num_good_left_out;
        if (left_out_since_s < 0.0) left_out_since_s = now_s;
        left_out_most_s = std::max(left_out_most_s, now_s - left_out_since_s);
      }
    } else if (const auto* imu = std::get_if<pose::Imu>(&*message)) {
      localiser.add(pose::Measurement(*imu));
    } else {
      continue;
    }
    use(mapped.hear(localiser));
    if (const auto estimate = localiser.estimate()) {
      const double time_s = seconds(estimate->utime);
      if (live.empty() || time_s > live.back().time_s) {
        live.push_back({time_s, estimate->x_m, estimate->y_m});
        nees_live = nees2(*estimate, simulator.scene().path.pose_at(time_s));
      }
    }
  }
  add_gap(simulator.scene().path.duration_s() + 1.0);
  use(mapped.finish(localiser));
  const Judged now = judge(live, gaps, simulator.scene());
  const Judged then = judge(smooth, gaps, simulator.scene());
  const JudgedTrack driven = judge(mapped.poses(), simulator.scene());
  trials::print_json({{"seed", seed},
                      {"fixes", num_fixes},
                      {"gaps", gaps.size()},
                      {"told_m", now.outside.rms_m()},
                      {"told_most_m", now.outside.most_m},
                      {"smoothed_m", then.outside.rms_m()},
                      {"smoothed_most_m", then.outside.most_m},
                      {"path_m", std::sqrt((then.outside.sum2 + then.inside.sum2) /
                                           std::max(1, then.outside.num + then.inside.num))},
                      {"mapped_m", driven.rms_m},
                      {"mapped_step_m", driven.excess_most_m},
                      {"key_poses", smooth.size()},
                      {"worst_gap", then.fraction_worst},
                      {"gaps_good", then.num_fractions_good},
                      {"good_left_out", num_good_left_out},
                      {"left_out_s", left_out_most_s},
                      {"nees_told", nees_live},
                      {"nees_smoothed", nees_smooth}});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: satellites RIG SCENE FIRST LAST\n");
    return 2;
  }
  try {
    auto config = io::load_config(argv[1]);
    config.simulation.scanner.rate_hz = 0.0;  // mode fused uses no scans
    const auto kind = simulation::find_scene(argv[2]);
    if (!kind) return 2;
    for (unsigned long seed = std::strtoul(argv[3], nullptr, 10);
         seed <= std::strtoul(argv[4], nullptr, 10); ++seed) {
      run(config, *kind, seed);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
