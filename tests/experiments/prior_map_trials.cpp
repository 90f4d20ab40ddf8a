// SPDX-License-Identifier: BSD-3-Clause
// For people: localisation in a prior map over many random blocks, without rendering. See --help.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
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
  explicit Block(std::uint64_t seed, const pose::PriorWorldOptions& options = {},
                 double change = 0.05)
      : before(pose::prior_world(seed, options)),
        now(pose::changed(before, seed, change)),
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

struct GlobalCount {
  int trials = 0, right = 0, wrong = 0, later_wrong = 0, undecided = 0;
  std::vector<double> travel_m;
};

void global_trial(std::uint64_t seed, const Block& block,
                  const std::vector<pose::PriorLandmark>& map, GlobalCount& count, bool verbose) {
  simulation::Random random(seed, simulation::Stream::kBench, 3);
  pose::PoseConfig config;
  config.mode = pose::PoseMode::kPriorMap;
  pose::PriorMapLocaliser localiser(config, map);
  double found_m = -1.0;
  bool first_right = false, wrong_later = false;
  Error first;
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
                  first = error;
                  first_right = error.right();
                }
                wrong_later = wrong_later || !error.right();
                return driven_m < found_m + kAfterM;
              });
  ++count.trials;
  if (found_m < 0.0) {
    ++count.undecided;
  } else if (first_right) {
    ++count.right;
    count.travel_m.push_back(found_m);
    count.later_wrong += wrong_later;
  } else {
    ++count.wrong;
  }
  if (verbose && (found_m < 0.0 || !first_right || wrong_later)) {
    std::printf("  seed %llu: %s at %.1f m, error %.2f m %.2f rad, way %.1f to %.1f m: %s\n",
                static_cast<unsigned long long>(seed),
                found_m < 0.0 ? "undecided"
                : first_right ? "wrong later"
                              : "wrong",
                found_m, first.position_m, first.yaw_rad, stretch.from_m, stretch.to_m,
                localiser.warning().c_str());
  }
}

void print(const char* name, const GlobalCount& c) {
  std::printf(
      "%s: %d trials: right %d (%.2f %%), undecided after %.0f m %d, confidently wrong %d (%.2f "
      "%%), "
      "wrong within %.0f m after %d; travel until found: median %.1f m, 95 %% %.1f m, most %.1f "
      "m\n",
      name, c.trials, c.right, 100.0 * c.right / std::max(1, c.trials), kGlobalTravelM, c.undecided,
      c.wrong, 100.0 * c.wrong / std::max(1, c.trials), kAfterM, c.later_wrong,
      geometry::quantile(c.travel_m, 0.5), geometry::quantile(c.travel_m, 0.95),
      geometry::quantile(c.travel_m, 1.0));
}

void carried_trials(std::uint64_t first, std::uint64_t last) {
  int trials = 0, noticed = 0, recovered = 0, within_15_m = 0, wrong = 0;
  std::vector<double> recovery_m, notice_m;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const Block block(seed);
    simulation::Random random(seed, simulation::Stream::kBench, 4);
    pose::PoseConfig config;
    config.mode = pose::PoseMode::kPriorMap;
    config.prior_map.start = pose::PriorStart::kGiven;
    // inside an alley, then inside another
    const double alley_m = block.before.length_m + 6.0 + 2.0 * geometry::kPi;
    const auto alley = static_cast<double>(random.bits() % 9);
    const auto other = std::fmod(alley + 1.0 + static_cast<double>(random.bits() % 8), 9.0);
    const double before_m = alley * alley_m + random.uniform(3.0, 40.0);
    const double after_m = other * alley_m + random.uniform(3.0, block.before.length_m - 25.0);
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
    ++trials;
    noticed += noticed_m >= 0.0;
    recovered += recovered_m >= 0.0;
    within_15_m += recovered_m >= 0.0 && recovered_m <= 15.0;
    wrong += wrong_again;
    if (recovered_m >= 0.0) recovery_m.push_back(recovered_m);
    if (noticed_m >= 0.0) notice_m.push_back(noticed_m);
    if (recovered_m < 0.0 || recovered_m > 15.0 || wrong_again) {
      std::printf("  seed %llu: noticed %.1f m, recovered %.1f m%s: %s\n",
                  static_cast<unsigned long long>(seed), noticed_m, recovered_m,
                  wrong_again ? ", wrong" : "", localiser.warning().c_str());
    }
  }
  std::printf(
      "carried: %d trials: noticed %d, recovered %d, within 15 m %d (%.2f %%), confidently wrong "
      "%d; "
      "noticed after: median %.1f m, most %.1f m; recovered after: median %.1f m, 95 %% %.1f m, "
      "most %.1f m\n",
      trials, noticed, recovered, within_15_m, 100.0 * within_15_m / std::max(1, trials), wrong,
      geometry::quantile(notice_m, 0.5), geometry::quantile(notice_m, 1.0),
      geometry::quantile(recovery_m, 0.5), geometry::quantile(recovery_m, 0.95),
      geometry::quantile(recovery_m, 1.0));
}

void tracking_trials(std::uint64_t first, std::uint64_t last) {
  double worst_m = 0.0, worst_deg = 0.0, sum2 = 0.0, sum_yaw2 = 0.0, nees = 0.0, most_us = 0.0;
  double largest_m = 0.0;
  long num = 0, num_scans = 0, num_without = 0, num_lost = 0;
  double total_us = 0.0;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const Block block(seed);
    pose::PoseConfig config;
    config.mode = pose::PoseMode::kPriorMap;
    config.prior_map.start = pose::PriorStart::kGiven;
    config.prior_map.start_x_m = block.way.front().x();
    config.prior_map.start_y_m = block.way.front().y();
    config.prior_map.start_yaw_rad = block.way.front().z();
    pose::PriorMapLocaliser localiser(config, block.map);
    double run2 = 0.0, run_yaw2 = 0.0;
    long run_num = 0;
    std::string said;
    pose::drive(
        block.now, block.way, {{0.0, block.way_m}}, seed, {},
        [&](const pose::Measurement& m, const Eigen::Vector3d& T, double driven_m) {
          const auto begin = std::chrono::steady_clock::now();
          localiser.add(m);
          const std::chrono::duration<double, std::micro> took =
              std::chrono::steady_clock::now() - begin;
          total_us += took.count();
          if (!std::holds_alternative<detection::Detections>(m)) return true;
          most_us = std::max(most_us, took.count());
          ++num_scans;
          const auto estimate = localiser.estimate();
          if (localiser.warning() != said) {
            said = localiser.warning();
            std::printf("  seed %llu at %.1f m: %s\n", static_cast<unsigned long long>(seed),
                        driven_m, said.empty() ? "found" : said.c_str());
          }
          if (!estimate) {
            ++num_without;
            return true;
          }
          if (driven_m < 1.0) return true;
          const Error error = error_of(*estimate, T);
          largest_m = std::max(largest_m, error.position_m);
          run2 += error.position_m * error.position_m;
          run_yaw2 += error.yaw_rad * error.yaw_rad;
          const double det = estimate->covariance[0] * estimate->covariance[3] -
                             estimate->covariance[1] * estimate->covariance[1];
          const double dx = estimate->x_m - T.x(), dy = estimate->y_m - T.y();
          nees += (estimate->covariance[3] * dx * dx - 2.0 * estimate->covariance[1] * dx * dy +
                   estimate->covariance[0] * dy * dy) /
                  det;
          ++run_num;
          return true;
        });
    num_lost += localiser.num_lost();
    sum2 += run2;
    sum_yaw2 += run_yaw2;
    num += run_num;
    const auto n = static_cast<double>(std::max(1L, run_num));
    worst_m = std::max(worst_m, std::sqrt(run2 / n));
    worst_deg = std::max(worst_deg, std::sqrt(run_yaw2 / n) * 180.0 / geometry::kPi);
  }
  const auto n = static_cast<double>(std::max(1L, num));
  std::printf(
      "tracking: %llu drives: RMSE %.3f m, %.2f deg (worst drive %.3f m, %.2f deg; largest error "
      "%.2f m), NEES %.2f of 2, lost %ld times, without a pose %.2f %% of scans; %.0f us a scan, "
      "most %.0f us\n",
      static_cast<unsigned long long>(last - first + 1), std::sqrt(sum2 / n),
      std::sqrt(sum_yaw2 / n) * 180.0 / geometry::kPi, worst_m, worst_deg, largest_m, nees / n,
      num_lost, 100.0 * static_cast<double>(num_without) / static_cast<double>(num_scans),
      total_us / static_cast<double>(num_scans), most_us);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::printf(
        "usage: prior_map_trials WHAT FIRST LAST (seeds)\n"
        "  global    start anywhere in the mapped block, 5 %% of its trees changed\n"
        "  regular   the same in a block whose trees stand on an exact grid, none missing\n"
        "  foreign   the same with the map of another block\n"
        "  carried   tracking, then carried to another alley\n"
        "  tracking  all alleys and headland turns from a given start\n");
    return 2;
  }
  const std::string what = argv[1];
  const std::uint64_t first = std::strtoull(argv[2], nullptr, 10);
  const std::uint64_t last = std::strtoull(argv[3], nullptr, 10);
  GlobalCount count;
  if (what == "tracking") {
    tracking_trials(first, last);
  } else if (what == "carried") {
    carried_trials(first, last);
  } else if (what == "global" || what == "regular" || what == "foreign") {
    pose::PriorWorldOptions options;
    if (what == "regular") options.jitter_m = options.missing_fraction = options.width_sd_m = 0.0;
    for (std::uint64_t seed = first; seed <= last; ++seed) {
      const Block block(seed, options, what == "regular" ? 0.0 : 0.05);
      global_trial(seed, block, what == "foreign" ? Block(seed + 1000000).map : block.map, count,
                   what == "global");
    }
    print(what.c_str(), count);
  } else {
    std::fprintf(stderr, "there is no trial \"%s\"\n", what.c_str());
    return 2;
  }
  return 0;
}
