// SPDX-License-Identifier: BSD-3-Clause
// Writes a drive through streets of houses, hedges and trees: many thousand rough things that look
// like trunks, a scan a metre. What a map of it costs, and how far its path is off, tells what
// closing loops costs where nearly all that is seen is no tree.
//   campus streets SEED OUT.lcm POSES.csv   2.2 km, streets driven twice
//   campus silent SEED OUT.lcm POSES.csv    the same, without wheels for 20 s after 900 m
//   campus round SEED OUT.lcm POSES.csv     1.8 km, around all blocks and on for 140 m
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/messages/message.hpp"
#include "geometry/pose2.hpp"
#include "io/log/log_writer.hpp"
#include "simulation/random.hpp"
#include "simulation/simulator.hpp"
#include "text/number_text.hpp"

namespace {

using namespace orchard;
using Eigen::Vector2d;

/// A wall or a hedge, whose surface is rough by so much.
struct Side {
  Vector2d a, b;
  double rough_m = 0.0;
};

struct Trunk {
  Vector2d p;
  double radius_m = 0.15;
};

struct Campus {
  std::vector<Side> sides;
  std::vector<Trunk> trunks;
  std::vector<Vector2d> waypoints;
};

constexpr double kBlockEast_m = 70.0, kBlockNorth_m = 50.0;

/// Blocks between streets: along each street lots of 14 m with a hedge in front, an entrance, a
/// house behind it and now and then a tree.
Campus campus(bool is_round, std::uint64_t seed) {
  simulation::Random random(seed, simulation::Stream::kScene);
  Campus campus;
  const int blocks_east = is_round ? 8 : 4, blocks_north = is_round ? 5 : 3;
  const auto lot = [&](const Vector2d& corner, const Vector2d& along, double length_m) {
    const Vector2d inwards(-along.y(), along.x());
    const auto at = [&](double s_m, double d_m) -> Vector2d {
      return corner + s_m * along + d_m * inwards;
    };
    const double gap_m = random.uniform(2.5, 4.0), gap_at_m = random.uniform(1.0, length_m - 5.0);
    const double hedge_m = random.uniform(3.5, 4.5);
    if (random.uniform() < 0.8) {
      campus.sides.push_back({at(0.3, hedge_m), at(gap_at_m, hedge_m), 0.15});
      campus.sides.push_back({at(gap_at_m + gap_m, hedge_m), at(length_m - 0.3, hedge_m), 0.15});
    }
    const double from_m = random.uniform(1.0, 3.0), to_m = random.uniform(9.0, 12.0);
    const double front_m = random.uniform(7.0, 10.0), back_m = front_m + random.uniform(5.0, 8.0);
    const Vector2d house[] = {at(from_m, front_m), at(to_m, front_m), at(to_m, back_m),
                              at(from_m, back_m)};
    for (int i = 0; i < 4; ++i) campus.sides.push_back({house[i], house[(i + 1) % 4], 0.01});
    for (int i = 0; i < 2; ++i) {
      if (random.uniform() > 0.6) continue;
      const double s_m = random.uniform(0.5, length_m - 0.5), d_m = random.uniform(2.2, 6.5);
      campus.trunks.push_back({at(s_m, d_m), random.uniform(0.08, 0.3)});
    }
  };
  for (int i = 0; i < blocks_east; ++i) {
    for (int j = 0; j < blocks_north; ++j) {
      const Vector2d south_west(i * kBlockEast_m, j * kBlockNorth_m);
      const Vector2d south_east = south_west + Vector2d(kBlockEast_m, 0.0);
      const Vector2d north_east = south_east + Vector2d(0.0, kBlockNorth_m);
      const Vector2d north_west = south_west + Vector2d(0.0, kBlockNorth_m);
      for (int k = 0; k < 5; ++k) {
        lot(south_west + Vector2d(14.0 * k, 0.0), {1.0, 0.0}, 14.0);
        lot(north_east - Vector2d(14.0 * k, 0.0), {-1.0, 0.0}, 14.0);
      }
      lot(south_east + Vector2d(0.0, 18.0), {0.0, 1.0}, 14.0);
      lot(north_west - Vector2d(0.0, 18.0), {0.0, -1.0}, 14.0);
    }
  }
  // In units of blocks: around, through the streets within, and some of them again.
  const std::vector<std::pair<int, int>> corners{{0, 0}, {4, 0}, {4, 3}, {0, 3}, {0, 1}, {3, 1},
                                                 {3, 2}, {1, 2}, {1, 0}, {2, 0}, {2, 3}, {4, 3},
                                                 {4, 1}, {0, 1}, {0, 0}, {2, 0}};
  const std::vector<std::pair<int, int>> around{{0, 0}, {8, 0}, {8, 5}, {0, 5}, {0, 0}, {2, 0}};
  for (const auto& [i, j] : is_round ? around : corners)
    campus.waypoints.push_back({i * kBlockEast_m, j * kBlockNorth_m});
  return campus;
}

/// Distance to a side along a ray [m]; infinite if it is not hit. Roughness is that of the place.
double hit_m(const Side& side, const Vector2d& from, const Vector2d& towards) {
  const Vector2d along = side.b - side.a, to = side.a - from;
  const double across = towards.x() * along.y() - towards.y() * along.x();
  if (std::abs(across) < 1e-9) return INFINITY;
  const double range_m = (to.x() * along.y() - to.y() * along.x()) / across;
  const double part = (to.x() * towards.y() - to.y() * towards.x()) / across;
  if (range_m <= 0.0 || part < 0.0 || part > 1.0) return INFINITY;
  const double s_m = part * along.norm() + 3.7 * side.a.x() + 1.3 * side.a.y();
  const double wave = std::sin(9.1 * s_m) + std::sin(4.3 * s_m + 1.0) + std::sin(23.7 * s_m + 2.0);
  return range_m + 0.8 * side.rough_m * wave;
}

double hit_m(const Trunk& trunk, const Vector2d& from, const Vector2d& towards) {
  const Vector2d to = trunk.p - from;
  const double along_m = to.dot(towards), across2 = to.squaredNorm() - along_m * along_m;
  const double half2 = trunk.radius_m * trunk.radius_m - across2;
  return along_m > 0.0 && half2 > 0.0 ? along_m - std::sqrt(half2) : INFINITY;
}

laser::Scan scan_at(const Campus& campus, const Eigen::Vector3d& T_map_laser,
                    simulation::Random& random) {
  constexpr double kRangeMax_m = 50.0;
  laser::Scan scan;
  scan.bearing_min_rad = -geometry::kPi / 2;
  scan.bearing_step_rad = geometry::kPi / 360.0;
  scan.range_min_m = 0.2;
  scan.range_max_m = kRangeMax_m;
  const Vector2d from = T_map_laser.head<2>();
  std::vector<Side> sides;
  std::vector<Trunk> trunks;
  for (const Side& s : campus.sides) {
    if ((0.5 * (s.a + s.b) - from).norm() < kRangeMax_m + 10.0) sides.push_back(s);
  }
  for (const Trunk& t : campus.trunks) {
    if ((t.p - from).norm() < kRangeMax_m) trunks.push_back(t);
  }
  for (int i = 0; i <= 360; ++i) {
    const double bearing_rad = T_map_laser.z() + scan.bearing_rad(i);
    const Vector2d towards(std::cos(bearing_rad), std::sin(bearing_rad));
    double range_m = INFINITY;
    for (const Side& s : sides) range_m = std::min(range_m, hit_m(s, from, towards));
    for (const Trunk& t : trunks) range_m = std::min(range_m, hit_m(t, from, towards));
    range_m += random.normal(0.0, 0.015);
    scan.ranges_m.push_back(range_m < kRangeMax_m ? static_cast<float>(range_m) : 0.0f);
  }
  return scan;
}

void run(const std::string& route, std::uint64_t seed, const char* log, const char* poses) {
  const Campus world = campus(route == "round", seed);
  simulation::Random noise(seed, simulation::Stream::kOdometry);
  simulation::Random scan_noise(seed, simulation::Stream::kScan);
  const double scale = noise.normal(0.0, 0.015), turn_scale = noise.normal(0.0, 0.015);
  const double bias_radps = noise.normal(0.0, 0.002);
  io::LogWriter writer(log);
  const auto write = [&](const auto& m) {
    const bus::Message message(m);
    writer.write(m.utime, bus::info(bus::channel_of(message)).name, bus::encode(message));
  };
  std::ofstream csv(poses);
  csv << "utime_us,x_m,y_m,yaw_rad\n";
  constexpr double kStep_s = 0.1, kSpeed_mps = 1.0;
  Eigen::Vector3d T(0.0, 0.0, 0.0);
  std::size_t next = 1;
  double yaw_rate_radps = 0.0;
  for (int step = 0; next < world.waypoints.size(); ++step) {
    const std::int64_t utime = simulation::kEpochUtime + 100'000 * step;
    pose::Odometry odometry;
    odometry.utime = utime;
    odometry.seq = step;
    odometry.speed_mps = kSpeed_mps * (1.0 + scale) + noise.normal(0.0, 0.02);
    odometry.yaw_rate_radps =
        yaw_rate_radps * (1.0 + turn_scale) + bias_radps + noise.normal(0.0, 0.005);
    if (route != "silent" || step < 9000 || step > 9200) write(odometry);
    csv << utime << ',' << fixed_text(T.x(), 4) << ',' << fixed_text(T.y(), 4) << ','
        << fixed_text(T.z(), 5) << '\n';
    if (step % 10 == 0) {
      laser::Scan scan =
          scan_at(world, geometry::compose(T, Eigen::Vector3d(0.3, 0.0, 0.0)), scan_noise);
      scan.utime = utime;
      scan.seq = step / 10;
      write(scan);
    }
    Vector2d leg = Vector2d::Zero();
    double along_m = 0.0;
    for (; next < world.waypoints.size(); ++next) {
      leg = world.waypoints[next] - world.waypoints[next - 1];
      along_m = (T.head<2>() - world.waypoints[next - 1]).dot(leg) / leg.norm();
      if (along_m < leg.norm() - 3.0) break;
    }
    if (next == world.waypoints.size()) break;
    const Vector2d aim = world.waypoints[next - 1] + leg / leg.norm() * (along_m + 3.0);
    const Vector2d ahead = geometry::inverse_transform(T, aim);
    yaw_rate_radps = std::clamp(1.2 * std::atan2(ahead.y(), ahead.x()), -0.6, 0.6);
    const double turn_rad = yaw_rate_radps * kStep_s;
    T = geometry::compose(T,
                          Eigen::Vector3d(kSpeed_mps * kStep_s * std::cos(turn_rad / 2),
                                          kSpeed_mps * kStep_s * std::sin(turn_rad / 2), turn_rad));
  }
  writer.close();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: campus streets|silent|round SEED OUT.lcm POSES.csv\n");
    return 2;
  }
  try {
    run(argv[1], std::strtoull(argv[2], nullptr, 10), argv[3], argv[4]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
