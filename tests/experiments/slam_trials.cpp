// SPDX-License-Identifier: BSD-3-Clause
// SLAM on trunks over many seeds without ray casting: what wheels with memory and a scanner say in
// scene park, or in rows that are left, lost by some metres and entered again; `fixes`: with a
// receiver that is silent on the way round and comes in bursts, of which some err together;
// `twins`: and the rows that are entered are not those that were left, but planted alike.
//   slam_trials park|rows|fixes|twins FIRST LAST

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiments/json_line.hpp"
#include "geometry/angles.hpp"
#include "geometry/georeference.hpp"
#include "geometry/pose2.hpp"
#include "geometry/rigid_fit2.hpp"
#include "pose/filter/on_earth.hpp"
#include "pose/slam/trunk_slam.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/scenes.hpp"
#include "simulation/sensor/motion_sensors.hpp"
#include "unit/pose/prior_map/noisy_trunk.hpp"

namespace orchard {
namespace {

using simulation::Random;
using simulation::Stream;

constexpr std::int64_t kStart = 1'000'000;
constexpr double kOdometryPeriod_s = 0.04;
constexpr int kOdometryPerScan = 5;
constexpr int kAspects = 12;  // sides of a trunk that is not round

struct Tree {
  Eigen::Vector2d p_map;
  double width_m = 0.0;
};

/// Fixes within a time; all of a burst that errs are displaced alike.
struct Burst {
  double begin_s = 0.0, end_s = 0.0;
  Eigen::Vector2d off_m = Eigen::Vector2d::Zero();
};

struct World {
  std::vector<Tree> trees;
  simulation::DrivePath path;
  double range_m = 40.0;
  double half_angle_rad = 0.5 * geometry::kPi;
  double beam_rad = 0.00872664626;
  double range_sd_m = 0.02;
  double laser_x_m = 3.0;
  double out_of_round = 0.05;  // of a trunk's centre by its side, per width
  double false_per_scan = 0.2;
  simulation::MotionConfig motion;
  simulation::WheelsConfig wheels;
  double again_s = 1e9;   // when the same rows are entered again
  double silent_s = 1e9;  // when they are left
  std::vector<Burst> bursts;
};

World park(std::uint64_t seed) {
  World world;
  const simulation::Scene scene = simulation::make_park_scene(seed, {});
  for (const simulation::TruthObject& thing : scene.truth) {
    if (thing.label == detection::Label::kTree) {
      world.trees.push_back({{thing.x_m, thing.y_m}, thing.width_m});
    }
  }
  world.path = scene.path;
  // as config/park.yaml
  world.motion.speed_scale_sd = 0.03;
  world.motion.speed_sd_mps = 0.05;
  world.motion.yaw_rate_bias_sd_radps = 0.003;
  world.motion.yaw_rate_sd_radps = 0.01;
  world.wheels.yaw_rate_scale_sd = 0.03;
  world.wheels.surface_slip_sd = 0.02;
  world.wheels.surface_turn_slip_sd = 0.05;
  world.wheels.load_sd = 0.01;
  world.wheels.bias_wander_sd_radps = 0.003;
  world.wheels.states_covariance = false;
  return world;
}

/// Eight rows, every aisle driven; home by a long way round where nothing stands, on which the
/// wheels drift by metres; then some aisles again, from another one on.
World rows(std::uint64_t seed, bool twins = false) {
  World world;
  Random random(seed, Stream::kScene);
  constexpr int kTrees = 24;
  constexpr double kRow_m = 4.0, kTree_m = 2.5, kTwin_m = 6.0 * kRow_m;
  const int num_rows = twins ? 4 : 8;
  for (int r = 0; r < num_rows; ++r) {
    for (int t = 0; t < kTrees; ++t) {
      const bool missing = random.uniform() < 0.08;
      const double dx_m = random.uniform(-0.15, 0.15), dy_m = random.uniform(-0.15, 0.15);
      const double width_m = random.normal(0.125, 0.012);
      if (missing) continue;
      const Eigen::Vector2d p_map(t * kTree_m + dx_m + 5.0, (r - 0.5) * kRow_m + dy_m);
      world.trees.push_back({p_map, width_m});
      if (twins) world.trees.push_back({p_map + Eigen::Vector2d(0.0, kTwin_m), width_m});
    }
  }
  world.path = simulation::DrivePath({0.0, 0.0, 0.0}, 1.0);
  const double length_m = (kTrees - 1) * kTree_m + 10.0;
  constexpr double kTurn_m = 5.0;
  const auto aisles = [&](int num, double side) {
    for (int a = 0; a < num; ++a) {
      world.path.append(length_m, 0.0);
      if (a + 1 == num) break;
      world.path.append(0.5 * geometry::kPi * kRow_m, side * 2.0 / kRow_m);
      side = -side;
    }
  };
  const auto quarter = [&] { world.path.append(0.5 * geometry::kPi * kTurn_m, 1.0 / kTurn_m); };
  aisles(num_rows - 1, 1.0);
  world.silent_s = world.path.duration_s();
  const double last_y_m = (num_rows - 2) * kRow_m;
  const double away_m = random.uniform(60.0, 120.0);
  const double again_y_m =
      twins ? kTwin_m : kRow_m * std::floor(random.uniform(0.0, num_rows - 3.0));
  world.path.append(20.0, 0.0);
  quarter();
  world.path.append(away_m, 0.0);
  quarter();
  world.path.append(length_m + 30.0, 0.0);
  quarter();
  world.path.append(last_y_m + away_m - again_y_m, 0.0);
  quarter();
  world.path.append(10.0, 0.0);
  world.again_s = world.path.duration_s();
  aisles(3, 1.0);
  world.range_m = 10.0;
  world.half_angle_rad = 2.09;
  world.beam_rad = 0.00613592315;
  world.range_sd_m = 0.01;
  world.laser_x_m = 0.35;
  world.motion.speed_scale_sd = 0.03;
  world.motion.yaw_rate_sd_radps = 0.01;
  world.wheels.yaw_rate_scale_sd = 0.03;
  world.wheels.surface_slip_sd = 0.02;
  world.wheels.surface_turn_slip_sd = 0.03;
  world.wheels.bias_wander_sd_radps = 0.001;
  world.wheels.states_covariance = false;
  return world;
}

constexpr double kFixPeriod_s = 0.3;
constexpr double kFixSd_m = 0.3;
constexpr double kBurst_s = 8.0;       // in the rows, every 40 s
constexpr double kBurstLate_s = 25.0;  // once, in the rows entered again
constexpr double kAstray = 0.25;       // of bursts
const geometry::Georeference kDatum{52.0, 5.0, 10.0, 0.0, 0.0, 0.0, 0.0};

void add_receiver(std::uint64_t seed, World& world) {
  Random random(seed, Stream::kGnss);
  for (double t_s = 0.0; t_s < world.silent_s; t_s += 40.0) {
    Burst burst{t_s, t_s + kBurst_s};
    if (t_s > 0.0 && random.uniform() < kAstray) {
      const double way_rad = random.uniform(-geometry::kPi, geometry::kPi);
      burst.off_m =
          random.uniform(4.0, 12.0) * Eigen::Vector2d(std::cos(way_rad), std::sin(way_rad));
    }
    world.bursts.push_back(burst);
  }
  world.bursts.push_back({world.again_s + 15.0, world.again_s + 15.0 + kBurstLate_s});
}

std::optional<pose::Gnss> fix_at(const World& world, std::uint64_t seed, double t_s,
                                 std::int64_t utime, const Eigen::Vector2d& p_map) {
  const auto burst = std::find_if(world.bursts.begin(), world.bursts.end(), [&](const Burst& b) {
    return t_s >= b.begin_s && t_s < b.end_s;
  });
  if (burst == world.bursts.end()) return std::nullopt;
  Random noise(seed, Stream::kGnss, static_cast<std::uint64_t>(utime));
  const Eigen::Vector2d seen =
      p_map + burst->off_m +
      Eigen::Vector2d(noise.normal(0.0, kFixSd_m), noise.normal(0.0, kFixSd_m));
  const geometry::Geodetic g = geometry::geodetic_of(kDatum, seen);
  pose::Gnss fix;
  fix.utime = utime;
  fix.latitude_deg = g.latitude_deg;
  fix.longitude_deg = g.longitude_deg;
  fix.altitude_m = kDatum.altitude_m;
  fix.fix_quality = 5;
  fix.covariance = {kFixSd_m * kFixSd_m, 0.0, 0.0, kFixSd_m * kFixSd_m, 0.0, 1.0};
  return fix;
}

/// What a scan holds of the trees.
detection::Detections observe(const World& world, std::uint64_t seed, std::int64_t utime,
                              const Eigen::Vector3d& T_map_base, Random& random) {
  detection::Detections seen;
  seen.utime = utime;
  const Eigen::Vector3d T = geometry::compose(T_map_base, {world.laser_x_m, 0.0, 0.0});
  struct InView {
    std::size_t tree;
    double range_m, bearing_rad, half_rad;
  };
  std::vector<InView> view;
  for (std::size_t i = 0; i < world.trees.size(); ++i) {
    const Eigen::Vector2d p = geometry::inverse_transform(T, world.trees[i].p_map);
    const double range_m = p.norm();
    if (range_m > world.range_m) continue;
    const double bearing_rad = std::atan2(p.y(), p.x());
    if (std::abs(bearing_rad) > world.half_angle_rad) continue;
    view.push_back({i, range_m, bearing_rad, 0.5 * world.trees[i].width_m / range_m});
  }
  std::sort(view.begin(), view.end(),
            [](const InView& a, const InView& b) { return a.range_m < b.range_m; });
  for (std::size_t v = 0; v < view.size(); ++v) {
    const InView& it = view[v];
    double hidden = 0.0;
    for (std::size_t n = 0; n < v; ++n) {
      const double overlap =
          std::min(it.bearing_rad + it.half_rad, view[n].bearing_rad + view[n].half_rad) -
          std::max(it.bearing_rad - it.half_rad, view[n].bearing_rad - view[n].half_rad);
      hidden = std::max(hidden, overlap / (2.0 * it.half_rad));
    }
    const double beams = 2.0 * it.half_rad / world.beam_rad;
    // two beams at least
    if (hidden > 0.3 || random.uniform() > beams - 1.0 || random.uniform() < 0.03) continue;
    const Tree& tree = world.trees[it.tree];
    const double aspect = geometry::wrap_angle_rad(T.z() + it.bearing_rad) + geometry::kPi;
    const auto side = static_cast<std::uint64_t>(aspect / (2.0 * geometry::kPi) * kAspects);
    Random shape(seed ^ 0x51ed27, Stream::kTargets, it.tree * kAspects + side);
    const double off_m = world.out_of_round * tree.width_m;
    const double radial_m = shape.normal(0.0, off_m), across_m = shape.normal(0.0, off_m);
    detection::Detection trunk = pose::noisy_trunk(
        {it.range_m + radial_m, it.bearing_rad + across_m / it.range_m, tree.width_m},
        {world.range_sd_m, 0.3 * world.beam_rad, 0.01, 0.4 * world.beam_rad}, 0.02, random);
    trunk.centre_x_m += world.laser_x_m;
    trunk.utime = utime;
    seen.trunks.push_back(trunk);
  }
  if (random.uniform() < world.false_per_scan) {
    const double range_m = random.uniform(1.0, world.range_m);
    const double bearing_rad = random.uniform(-world.half_angle_rad, world.half_angle_rad);
    detection::Detection trunk =
        pose::noisy_trunk({range_m, bearing_rad, 0.3}, {0.05, 0.01, 0.1, 0.0}, 0.02, random);
    trunk.utime = utime;
    seen.trunks.push_back(trunk);
  }
  return seen;
}

Eigen::Vector3d vector_of(const simulation::Pose2& pose) {
  return {pose.x_m, pose.y_m, pose.yaw_rad};
}

struct Result {
  double rmse_m = 0.0, end_m = 0.0, nees = 0.0, sd_m = 0.0;
  int mixed = 0;
  int closures = 0, refuted = 0, twice = 0, landmarks = 0, lost = 0, ambiguous = 0, scans = 0;
  double mops = 0.0, drift_m = 0.0;
  bool is_doubted = false;
  double off_m = 0.0;                    // without alignment, most, in the rows
  double late_m = 0.0, late_sd_m = 0.0;  // after the last burst
  int closures_again = 0;
};

Result drive(const World& world, std::uint64_t seed) {
  pose::PoseConfig config;
  config.slam.use_gnss = !world.bursts.empty();
  if (config.slam.use_gnss) {
    config.gnss.datum = {kDatum.latitude_deg, kDatum.longitude_deg, kDatum.altitude_m};
  }
  pose::TrunkSlam slam{config};
  pose::FixesOfDrive fixes(config.gnss);
  double fix_s = 0.0;
  Random run(seed, Stream::kOdometryRun);
  const auto errors = simulation::draw_odometry_errors(world.motion, world.wheels, run);
  const simulation::WheelErrorModel memory(seed, world.wheels, world.path.duration_s());
  const double duration_s = world.path.duration_s();
  Result result;
  for (int step = 0; step * kOdometryPeriod_s < duration_s; ++step) {
    const double t_s = step * kOdometryPeriod_s;
    const auto utime = kStart + static_cast<std::int64_t>(std::llround(t_s * 1e6));
    const simulation::Pose2 pose = world.path.pose_at(t_s);
    Random noise(seed, Stream::kOdometry, static_cast<std::uint64_t>(step));
    pose::Odometry odometry = simulation::simulate_odometry(world.path, t_s, kOdometryPeriod_s,
                                                            memory.errors_at(errors, t_s, pose),
                                                            world.motion, world.wheels, noise);
    odometry.utime = utime;
    slam.add(odometry);
    if (t_s >= fix_s) {
      fix_s += kFixPeriod_s;
      if (const auto fix = fix_at(world, seed, t_s, utime, {pose.x_m, pose.y_m})) {
        slam.add(pose::Measurement(*fix));
        fixes.add(*fix);
      }
    }
    if (step % kOdometryPerScan != 0) continue;
    Random scan(seed, Stream::kScan, static_cast<std::uint64_t>(step));
    slam.add(pose::Measurement(observe(world, seed, utime, vector_of(pose), scan)));
    ++result.scans;
    const std::string warning = slam.warning();
    result.lost += warning.rfind("LOST", 0) == 0;
    result.ambiguous += warning.rfind("AMBIGUOUS", 0) == 0;
    const auto estimate = slam.estimate();
    if (!estimate) continue;
    const double error_m = std::hypot(estimate->x_m - pose.x_m, estimate->y_m - pose.y_m);
    if (!world.bursts.empty() && t_s < world.bursts.back().end_s) {
      result.late_m = error_m;
      result.late_sd_m = std::sqrt(estimate->covariance[0] + estimate->covariance[3]);
    }
    if (t_s < world.again_s) {
      result.drift_m = error_m;
      result.closures_again = -slam.num_closures();
    }
  }
  slam.finish();
  std::vector<Eigen::Vector2d> told, truth;
  for (const pose::Keyframe& k : slam.graph().keyframes) {
    const simulation::Pose2 pose = world.path.pose_at(static_cast<double>(k.utime - kStart) * 1e-6);
    told.push_back(k.T_map_base.head<2>());
    truth.emplace_back(pose.x_m, pose.y_m);
    const double t_s = static_cast<double>(k.utime - kStart) * 1e-6;
    if (t_s < world.silent_s || t_s > world.again_s) {
      result.off_m = std::max(result.off_m, (told.back() - truth.back()).norm());
    }
  }
  const geometry::RigidFit2 fit = geometry::fit_rigid(truth, told);
  double sum = 0.0;
  for (std::size_t i = 0; i < told.size(); ++i) {
    sum += (geometry::transform(fit.T_a_b, told[i]) - truth[i]).squaredNorm();
  }
  result.rmse_m = std::sqrt(sum / static_cast<double>(told.size()));
  const auto estimate = slam.estimate();
  const simulation::Pose2 end =
      world.path.pose_at(static_cast<double>(estimate->utime - kStart) * 1e-6);
  const auto& c = estimate->covariance;
  Eigen::Matrix3d P;
  P << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  const Eigen::Vector3d e(estimate->x_m - end.x_m, estimate->y_m - end.y_m,
                          geometry::wrap_angle_rad(estimate->yaw_rad - end.yaw_rad));
  result.end_m = e.head<2>().norm();
  result.nees = e.dot(P.inverse() * e);
  result.sd_m = std::sqrt(c[0] + c[3]);
  result.closures = slam.num_closures();
  result.closures_again += result.closures;
  result.refuted = slam.num_refuted_closures();
  std::map<std::int64_t, Eigen::Vector3d> path;
  for (const pose::Keyframe& k : slam.graph().keyframes) path[k.utime] = k.T_map_base;
  const pose::OnEarth on_earth =
      fixes.along([&](std::int64_t utime) -> std::optional<pose::PoseEstimate> {
        const auto next = path.lower_bound(utime);
        if (next == path.end()) return std::nullopt;
        return pose::pose_estimate(utime, next->second, Eigen::Matrix3d::Zero());
      });
  result.is_doubted = on_earth.doubt.has_value();
  result.mops = static_cast<double>(slam.num_operations()) * 1e-6;
  // trees that are more than one landmark
  std::vector<int> times(world.trees.size(), 0);
  for (std::size_t i = 0; i < slam.graph().landmarks.size(); ++i) {
    const pose::SlamLandmark& l = slam.graph().landmarks[i];
    if (!l.alive || !l.confirmed) continue;
    ++result.landmarks;
    const Eigen::Vector2d p = geometry::transform(fit.T_a_b, l.p_map);
    std::size_t nearest = 0;
    for (std::size_t t = 0; t < world.trees.size(); ++t) {
      if ((world.trees[t].p_map - p).norm() < (world.trees[nearest].p_map - p).norm()) nearest = t;
    }
    if ((world.trees[nearest].p_map - p).norm() > 1.5) continue;
    ++times[nearest];
  }
  // landmarks that are more than one tree: what was observed of them lies apart in truth
  std::vector<std::vector<Eigen::Vector2d>> places(slam.graph().landmarks.size());
  for (const pose::Keyframe& k : slam.graph().keyframes) {
    const Eigen::Vector3d T =
        vector_of(world.path.pose_at(static_cast<double>(k.utime - kStart) * 1e-6));
    for (const pose::SlamObservation& o : k.observations) {
      places[static_cast<std::size_t>(o.landmark)].push_back(geometry::transform(T, o.position()));
    }
  }
  for (const std::vector<Eigen::Vector2d>& seen : places) {
    int far = 0;
    for (const Eigen::Vector2d& p : seen) far += (p - seen[0]).norm() > 1.2;
    result.mixed += far > 2;
  }
  for (const int n : times) result.twice += std::max(0, n - 1);
  return result;
}

}  // namespace
}  // namespace orchard

int main(int argc, char** argv) {
  using namespace orchard;
  if (argc != 4) {
    std::fprintf(stderr, "usage: slam_trials park|rows|fixes|twins FIRST LAST\n");
    return 2;
  }
  const std::uint64_t last = std::strtoull(argv[3], nullptr, 10);
  for (std::uint64_t seed = std::strtoull(argv[2], nullptr, 10); seed <= last; ++seed) {
    const std::string kind = argv[1];
    World world = kind == "park" ? park(seed) : rows(seed, kind == "twins");
    if (kind == "fixes" || kind == "twins") add_receiver(seed, world);
    const Result r = drive(world, seed);
    trials::print_json({{"seed", seed},
                        {"rmse_m", r.rmse_m},
                        {"end_m", r.end_m},
                        {"sd_m", r.sd_m},
                        {"nees", r.nees},
                        {"mixed", r.mixed},
                        {"closures", r.closures},
                        {"refuted", r.refuted},
                        {"twice", r.twice},
                        {"landmarks", r.landmarks},
                        {"lost", 1.0 * r.lost / r.scans},
                        {"ambiguous", 1.0 * r.ambiguous / r.scans},
                        {"mops", r.mops},
                        {"drift_m", r.drift_m},
                        {"closures_again", r.closures_again},
                        {"doubted", r.is_doubted},
                        {"off_m", r.off_m},
                        {"late_m", r.late_m},
                        {"late_sd_m", r.late_sd_m}});
  }
  return 0;
}
