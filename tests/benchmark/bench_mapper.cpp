// SPDX-License-Identifier: BSD-3-Clause
// Mapper::update along a robot's path on a map of 1e6 landmarks against one of 1e3, with scans
// fitted to the map (the default) and without; prints the ratios, and the bytes per landmark at
// 1e6.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "benchmark/result_line.hpp"
#include "mapping/mapper.hpp"

namespace {

using orchard::detection::Detection;
using orchard::detection::Detections;
using orchard::detection::Label;
using orchard::mapping::Mapper;
using orchard::pose::PoseEstimate;

constexpr double kRow_m = 4.0;
constexpr double kTree_m = 3.0;

Detection tree_at(double x_m, double y_m) {
  Detection d;
  d.centre_x_m = x_m;
  d.centre_y_m = y_m;
  d.covariance = {1e-4, 0.0, 1e-4};
  d.width_m = 0.2;
  d.width_sd_m = 0.02;
  d.label = Label::kTree;
  d.roc_tree = 0.9f;
  return d;
}

/// A square orchard of `n` trees in rows along x, each seen often enough to lead an alignment.
Mapper orchard_of(int n, bool align_scans) {
  orchard::mapping::MapperConfig config;
  config.align_scans = align_scans;
  const int side = static_cast<int>(std::lround(std::sqrt(n)));
  Mapper mapper(config);
  for (int pass = 0; pass < 3; ++pass) {
    for (int row = 0; row < side; ++row) {
      Detections detections;
      PoseEstimate pose;
      pose.y_m = kRow_m * row;
      for (int block = 0; block < side; block += 20) {
        detections.trunks.clear();
        pose.x_m = kTree_m * block;
        for (int k = 0; k < 20 && block + k < side; ++k) {
          detections.trunks.push_back(tree_at(kTree_m * k, 0.0));
        }
        mapper.update(detections, pose);
      }
    }
  }
  return mapper;
}

/// Best time of an update [s] by number of landmarks and whether scans are aligned.
std::map<std::pair<int, bool>, double>& best_seconds() {
  static std::map<std::pair<int, bool>, double> best;
  return best;
}
double bytes_per_landmark = 0.0;

/// One drive between two rows, 0.25 m a scan, six trees of each row in view; the pose is known to
/// 2 cm and 1 degree.
void drive(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const bool align_scans = state.range(1) != 0;
  Mapper mapper = orchard_of(n, align_scans);
  const int side = static_cast<int>(std::lround(std::sqrt(n)));
  bytes_per_landmark =
      static_cast<double>(mapper.num_bytes()) / static_cast<double>(mapper.num_landmarks());
  const int num_steps = 300;
  int lane = 0;
  for (auto _ : state) {
    const double y_m = kRow_m * (side / 2 + lane++ % (side / 4) + 0.5);
    const auto start = std::chrono::steady_clock::now();
    for (int step = 0; step < num_steps; ++step) {
      PoseEstimate pose;
      pose.x_m = 6.0 + 0.25 * (step % (4 * 60));
      pose.y_m = y_m;
      pose.covariance = {4e-4, 0.0, 0.0, 4e-4, 0.0, 3e-4};
      Detections detections;
      const int first = static_cast<int>(pose.x_m / kTree_m);
      for (int k = 0; k < 6; ++k) {
        for (const double side_m : {-0.5 * kRow_m, 0.5 * kRow_m}) {
          detections.trunks.push_back(tree_at(kTree_m * (first + k) - pose.x_m, side_m));
        }
      }
      benchmark::DoNotOptimize(mapper.update(detections, pose));
    }
    const double s =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / num_steps;
    double& best = best_seconds()[{n, align_scans}];
    if (best == 0.0 || s < best) best = s;
  }
  state.counters["us_per_scan"] = 1e6 * best_seconds()[{n, align_scans}];
  state.counters["bytes_per_landmark"] = bytes_per_landmark;
}
BENCHMARK(drive)
    ->ArgNames({"landmarks", "align"})
    ->ArgsProduct({{1000, 1000000}, {1, 0}})
    ->Iterations(60)
    ->Unit(benchmark::kMillisecond);

void print_ratio(bool align_scans, const char* what) {
  const auto& best = best_seconds();
  const auto small = best.find({1000, align_scans});
  const auto large = best.find({1000000, align_scans});
  if (small == best.end() || large == best.end()) return;  // left out by a filter
  const double ratio = large->second / small->second;
  char measured[64];
  std::snprintf(measured, sizeof measured, "%.2fx (%.1f us)", ratio, 1e6 * large->second);
  orchard::bench::print_result(what, measured, "<= 1.5x", ratio <= 1.5);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  print_ratio(true, "mapper update along a path, 1e6 landmarks against 1e3");
  print_ratio(false, "mapper update with align_scans: false, 1e6 against 1e3");
  if (bytes_per_landmark > 0.0) {
    char measured[32];
    std::snprintf(measured, sizeof measured, "%.0f bytes", bytes_per_landmark);
    orchard::bench::print_result("memory of a landmark, observations not counted", measured,
                                 "<= 160 bytes", bytes_per_landmark <= 160.0);
  }
  return 0;
}
