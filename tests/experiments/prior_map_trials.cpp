// SPDX-License-Identifier: BSD-3-Clause
// Localisation in a prior map over random blocks of 10 rows of 30 trees (4 m x 2.5 m, 8 % missing,
// 5 % changed since they were mapped), odometry 3 %, sightings of an URG-class scanner from
// geometry alone.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "experiments/json_line.hpp"
#include "geometry/angles.hpp"
#include "pose/prior_map/prior_map_localiser.hpp"
#include "simulation/random.hpp"
#include "unit/pose/prior_map/prior_world.hpp"

namespace {

using namespace orchard;
using pose::Stretch;

constexpr double kRightM = 0.5;
constexpr double kRightRad = 0.17;
constexpr double kGlobalTravelM = 30.0;
constexpr double kAfterM = 5.0;  ///< watched after a place was found

struct Error {
  double position_m = 0.0;
  double yaw_rad = 0.0;
  bool right() const { return position_m < kRightM && std::abs(yaw_rad) < kRightRad; }
};

Error error_of(const pose::PoseEstimate& estimate, const Eigen::Vector3d& T_map_base) {
  return {std::hypot(estimate.x_m - T_map_base.x(), estimate.y_m - T_map_base.y()),
          geometry::wrap_angle_rad(estimate.yaw_rad - T_map_base.z())};
}

struct Block {
  explicit Block(std::uint64_t seed)
      : before(pose::prior_world(seed, {})),
        now(pose::changed(before, seed, 0.05)),
        map(pose::mapped(before, seed)),
        way(pose::way_through(before)),
        way_m(0.02 * static_cast<double>(way.size())) {}
  pose::PriorWorld before, now;
  std::vector<pose::PriorLandmark> map;
  std::vector<Eigen::Vector3d> way;
  double way_m;
};

/// Somewhere on the way, in one of the two directions, with room ahead.
Stretch random_stretch(const Block& block, simulation::Random& random, double length_m) {
  const double from_m = random.uniform(0.0, block.way_m - length_m);
  const bool backwards = random.uniform() < 0.5;
  return backwards ? Stretch{from_m + length_m, from_m} : Stretch{from_m, from_m + length_m};
}

void global_trial(std::uint64_t seed, const Block& block,
                  const std::vector<pose::PriorLandmark>& map) {
  simulation::Random random(seed, simulation::Stream::kBench, 3);
  pose::PoseConfig config;
  config.mode = pose::PoseMode::kPriorMap;
  pose::PriorMapLocaliser localiser(config, map);
  double found_m = -1.0;
  bool first_right = false, wrong_later = false;
  const Stretch stretch = random_stretch(block, random, kGlobalTravelM + kAfterM);
  pose::drive(block.now, block.way, {stretch}, seed, {},
              [&](const pose::Measurement& m, const Eigen::Vector3d& T, double driven_m) {
                localiser.add(m);
                const auto estimate = localiser.estimate();
                if (found_m < 0.0 && driven_m > kGlobalTravelM) return false;
                if (!estimate) return true;
                const Error error = error_of(*estimate, T);
                if (found_m < 0.0) {
                  found_m = driven_m;
                  first_right = error.right();
                }
                wrong_later = wrong_later || !error.right();
                return driven_m < found_m + kAfterM;
              });
  trials::print_json({{"seed", seed},
                      {"right", found_m >= 0.0 && first_right},
                      {"wrong", found_m >= 0.0 && !first_right},
                      {"wrong_later", first_right && wrong_later},
                      {"travel_m", found_m}});
}

void carried_trials(std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const Block block(seed);
    simulation::Random random(seed, simulation::Stream::kBench, 4);
    pose::PoseConfig config;
    config.mode = pose::PoseMode::kPriorMap;
    config.prior_map.start = pose::PriorStart::kGiven;
    // inside an aisle, then inside another
    const double aisle_m = block.before.length_m + 6.0 + 2.0 * geometry::kPi;
    const auto aisle = static_cast<double>(random.bits() % 9);
    const auto other = std::fmod(aisle + 1.0 + static_cast<double>(random.bits() % 8), 9.0);
    const double before_m = aisle * aisle_m + random.uniform(3.0, 40.0);
    const double after_m = other * aisle_m + random.uniform(3.0, block.before.length_m - 25.0);
    const bool back = random.uniform() < 0.5;
    const Stretch before{before_m, before_m + 20.0};
    const Stretch after =
        back ? Stretch{after_m + 25.0, after_m} : Stretch{after_m, after_m + 25.0};
    const Eigen::Vector3d start = block.way[static_cast<std::size_t>(before_m / 0.02)];
    config.prior_map.start_x_m = start.x();
    config.prior_map.start_y_m = start.y();
    config.prior_map.start_yaw_rad = start.z();
    pose::PriorMapLocaliser localiser(config, block.map);
    double noticed_m = -1.0, recovered_m = -1.0;
    bool wrong_again = false;
    pose::drive(block.now, block.way, {before, after}, seed, {},
                [&](const pose::Measurement& m, const Eigen::Vector3d& T, double driven_m) {
                  localiser.add(m);
                  const auto estimate = localiser.estimate();
                  const double since_m = driven_m - 20.0;
                  if (since_m < 0.05) return true;
                  if (!estimate) {
                    if (noticed_m < 0.0) noticed_m = since_m;
                  } else if (error_of(*estimate, T).right()) {
                    if (recovered_m < 0.0) recovered_m = since_m;
                  } else if (noticed_m >= 0.0) {
                    wrong_again = true;
                  }
                  return true;
                });
    trials::print_json({{"seed", seed},
                        {"noticed_m", noticed_m},
                        {"recovered_m", recovered_m},
                        {"wrong_again", wrong_again}});
  }
}

void tracking_trials(std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const Block block(seed);
    pose::PoseConfig config;
    config.mode = pose::PoseMode::kPriorMap;
    config.prior_map.start = pose::PriorStart::kGiven;
    config.prior_map.start_x_m = block.way.front().x();
    config.prior_map.start_y_m = block.way.front().y();
    config.prior_map.start_yaw_rad = block.way.front().z();
    pose::PriorMapLocaliser localiser(config, block.map);
    double sum2 = 0.0, sum_yaw2 = 0.0, nees = 0.0, most_m = 0.0;
    long num = 0, num_scans = 0, num_without = 0;
    pose::drive(block.now, block.way, {{0.0, block.way_m}}, seed, {},
                [&](const pose::Measurement& m, const Eigen::Vector3d& T, double driven_m) {
                  localiser.add(m);
                  if (!std::holds_alternative<detection::Detections>(m)) return true;
                  ++num_scans;
                  const auto estimate = localiser.estimate();
                  if (!estimate) {
                    ++num_without;
                    return true;
                  }
                  if (driven_m < 1.0) return true;
                  const Error error = error_of(*estimate, T);
                  most_m = std::max(most_m, error.position_m);
                  sum2 += error.position_m * error.position_m;
                  sum_yaw2 += error.yaw_rad * error.yaw_rad;
                  const double det = estimate->covariance[0] * estimate->covariance[3] -
                                     estimate->covariance[1] * estimate->covariance[1];
                  const double dx = estimate->x_m - T.x(), dy = estimate->y_m - T.y();
                  nees +=
                      (estimate->covariance[3] * dx * dx - 2.0 * estimate->covariance[1] * dx * dy +
                       estimate->covariance[0] * dy * dy) /
                      det;
                  ++num;
                  return true;
                });
    const auto n = static_cast<double>(std::max(1L, num));
    trials::print_json(
        {{"seed", seed},
         {"rmse_m", std::sqrt(sum2 / n)},
         {"rmse_rad", std::sqrt(sum_yaw2 / n)},
         {"most_m", most_m},
         {"nees", nees / n},
         {"lost", localiser.num_lost()},
         {"without", static_cast<double>(num_without) / static_cast<double>(num_scans)}});
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::printf(
        "usage: prior_map_trials WHAT FIRST LAST (seeds)\n"
        "  global    start anywhere in the mapped block, 5 %% of its trees changed\n"
        "  foreign   the same with the map of another block\n"
        "  carried   tracking, then carried to another aisle\n"
        "  tracking  all aisles and headland turns from a given start\n");
    return 2;
  }
  const std::string what = argv[1];
  const std::uint64_t first = std::strtoull(argv[2], nullptr, 10);
  const std::uint64_t last = std::strtoull(argv[3], nullptr, 10);
  if (what == "tracking") {
    tracking_trials(first, last);
  } else if (what == "carried") {
    carried_trials(first, last);
  } else if (what == "global" || what == "foreign") {
    for (std::uint64_t seed = first; seed <= last; ++seed) {
      const Block block(seed);
      global_trial(seed, block, what == "foreign" ? Block(seed + 1000000).map : block.map);
    }
  } else {
    std::fprintf(stderr, "there is no trial \"%s\"\n", what.c_str());
    return 2;
  }
  return 0;
}
